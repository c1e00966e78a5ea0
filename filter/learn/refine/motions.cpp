// How many motions, and how many levels of noise.
#include "filter/step/motions.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>
#include <unsupported/Eigen/KroneckerProduct>
#include <utility>

#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/refine/cross_validation.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

constexpr std::array<Index, 3> tried_levels{1, 2, 4};
constexpr Index trial_iterations = 2, most_iterations = 20;  // of a split that is compared; of the one that goes on
constexpr Index stretches = 4;                               // random starts of a number of motions
constexpr double stay_of_motion = 0.99, stay_of_level = 0.98;

/// Every noise level becomes a quiet and a loud one.
Bank with_twice_the_levels(const Bank& bank) {
  constexpr std::array factors{0.5, 3.0};
  Bank twice = bank;
  twice.modes.clear();
  twice.motion.clear();
  for (Index j = 0; j < bank.mode_count(); ++j)
    for (const double factor : factors) {
      twice.modes.push_back(bank.modes[j]);
      twice.modes.back().Q *= factor;
      twice.motion.push_back(bank.motion_of(j));
    }
  twice.noise_levels = 2 * bank.noise_levels;
  const Eigen::MatrixXd of_levels = TransitionMatrix::sticky(2, stay_of_level).matrix();
  set_mode_sequence(twice, TransitionMatrix(Eigen::kroneckerProduct(bank.transition.matrix(), of_levels).eval()));
  return twice;
}

/// One motion more: a copy of `motion` with its increments times `pace`, and effects of inputs times `gain`.
Bank split(const Bank& bank, Index motion, double pace, double gain) {
  Bank more = bank;
  const Index L = bank.noise_levels, motions = bank.mode_count() / L;
  for (Index l = 0; l < L; ++l) {
    Mode mode = bank.modes[motion * L + l];
    mode.model = unpack(bank.structure, pace * bank.theta(motion * L));
    mode.model.B.topRows(bank.structure.states) *= gain;
    more.modes.push_back(std::move(mode));
    more.motion.push_back(motions);
  }
  const Eigen::MatrixXd of_levels = chains_of(bank.transition.matrix(), L).second,
                        of_motions = TransitionMatrix::sticky(motions + 1, stay_of_motion).matrix();
  set_mode_sequence(more, TransitionMatrix(Eigen::kroneckerProduct(of_motions, of_levels).eval()));
  return more;
}

struct MotionSearch {
  const RefineInput& in;
  bool unknown_states;
  CrossValidation& validation;
  std::map<std::pair<Index, Index>, Bank> learned = {};  ///< by numbers of motions and levels

  void run(Index most_motions) {
    const double limit = least_nats(validation.samples().sum(), in.single.response_samples);
    double fewer = -std::numeric_limits<double>::infinity();
    for (Index motions = 1; motions <= most_motions; ++motions) {
      double best = -std::numeric_limits<double>::infinity();
      for (const Index levels : tried_levels) {
        if (const Index most = in.options.most_modes; most > 0 && motions * levels > most) break;
        const double before = std::exchange(best, std::max(best, consider(motions, levels)));
        if (levels > 1 && best < before + limit) break;
      }
      if (best < fewer + limit) return;
      fewer = best;
    }
  }

  /// The sum of scores of left-out runs, which must be possible.
  double consider(Index motions, Index levels) {
    LearnedBank best = likeliest(starts(motions, levels), most_iterations, unknown_states);
    learned.insert_or_assign({motions, levels}, best.bank);
    const std::string name = fmt::format("motions x {}", levels);
    if (unknown_states)
      validation.consider(name, std::move(best));
    else
      validation.consider({{name, switching_model(best.bank)}});
    return validation.last().scores.log_likelihood.sum();
  }

  /// The likeliest of these banks after so many iterations of expectation-maximisation, or of a maximisation by the
  /// filter.
  LearnedBank likeliest(const std::vector<Bank>& starts, Index iterations, bool by_filter) const {
    std::vector<LearnedBank> ends(starts.size());
    tbb::parallel_for(std::size_t{0}, ends.size(), [&](std::size_t i) {
      if (by_filter) {
        ends[i] = maximise_measured(in, in.all, starts[i], iterations);
        return;
      }
      SwitchingFit fit{switching_model(starts[i])};
      iterate(in.all.transitions, in.prior(in.all), in.em(), iterations, fit);
      ends[i] = {with_modes(in.frame, fit.model), in.prior(in.all), fit.posterior.log_likelihood};
    });
    return std::move(*std::ranges::max_element(ends, is_below, &LearnedBank::log_likelihood));
  }

  std::vector<Bank> starts(Index motions, Index levels) const {
    std::vector<Bank> starts;
    if (levels == 1 || motions > 1) {
      starts.push_back(from_stretches(motions));
      while (starts.back().noise_levels < levels) starts.back() = with_twice_the_levels(starts.back());
    }
    if (const auto half = learned.find({motions, levels / 2}); half != learned.end())
      starts.push_back(with_twice_the_levels(half->second));
    if (const auto fewer = learned.find({motions - 1, levels}); fewer != learned.end())
      starts.push_back(likeliest(splits_of(fewer->second), trial_iterations, unknown_states).bank);
    return starts;
  }

  /// The likeliest bank of exact states from random stretches, with R taken out of Q.
  Bank from_stretches(Index motions) const {
    std::vector<Bank> starts;
    for (Index i = 0; i < (motions > 1 ? stretches : 1); ++i) {
      starts.push_back(with_modes(in.frame, start_from_stretches(in.all.transitions, in.prior(in.all), motions,
                                                                 in.fits.length, in.options.seed, i)));
      for (Index j = 0; j < motions; ++j) starts.back().motion.push_back(j);
    }
    Bank bank = likeliest(starts, in.options.max_iterations, false).bank;
    return unknown_states ? with_R_out_of_Q(in, std::move(bank)) : bank;
  }

  /// Every motion split in two, in four ways.
  static std::vector<Bank> splits_of(const Bank& bank) {
    constexpr std::array<std::pair<double, double>, 4> paces_and_gains{
        {{0.5, 1.0}, {2.0, 1.0}, {1.0, 1.5}, {1.0, 1.0 / 1.5}}};
    std::vector<Bank> splits;
    for (Index motion = 0; motion < bank.mode_count() / bank.noise_levels; ++motion)
      for (const auto& [pace, gain] : paces_and_gains) splits.push_back(split(bank, motion, pace, gain));
    return splits;
  }
};

/// The model whose modes of the closest two motions, in standard errors of theta, are modes of one motion.
SwitchingRegression with_closest_tied(const RefineInput& in, const SwitchingFit& fit) {
  const SwitchingRegression& model = fit.model;
  const Bank bank =
      with_complete_errors(in.all.transitions, fit.posterior, in.prior(in.all), with_modes(in.frame, model));
  double least = std::numeric_limits<double>::infinity();
  std::pair<Index, Index> closest{0, 0};  // first modes of the motions
  for (Index i = 0; i < model.modes(); i = model.end_of_motion(i))
    for (Index j = model.end_of_motion(i); j < model.modes(); j = model.end_of_motion(j)) {
      const Eigen::VectorXd difference = model.theta.col(i) - model.theta.col(j);
      const Eigen::MatrixXd V = bank.modes[i].parameter_covariance + bank.modes[j].parameter_covariance;
      const double distance = difference.dot(solve_semidefinite(V, difference));
      if (!(distance < least)) continue;
      least = distance;
      closest = {i, j};
    }
  const Index kept = bank.motion_of(closest.first), moved = bank.motion_of(closest.second);
  SwitchingRegression tied = model;
  tied.motion.clear();
  for (Index j = 0; j < model.modes(); ++j)
    tied.motion.push_back(bank.motion_of(j) == moved ? kept : bank.motion_of(j) - (bank.motion_of(j) > moved ? 1 : 0));
  std::vector<Index> order(tied.motion.size());  // modes of a motion in a row
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::stable_sort(order, {}, [&](Index j) { return tied.motion[j]; });
  std::ranges::sort(tied.motion);
  tied.theta = model.theta(Eigen::all, order);
  tied.transition = model.transition(order, order);
  tied.initial = model.initial(order);
  for (Index j = 0; j < model.modes(); ++j) tied.Q[j] = model.Q[order[j]];
  return tied;
}

}  // namespace

void consider_motions(const RefineInput& in, Index most, CrossValidation& validation) {
  MotionSearch{in, false, validation}.run(most);
  if (in.unknown_states) MotionSearch{in, true, validation}.run(most);
}

void consider_ties(const RefineInput& in, CrossValidation& validation) {
  while (true) {
    BankCandidate candidate = validation.chosen().candidate;
    if (!validation.chosen().exact() || candidate.start.noise_levels > 1 || validation.chosen().scores.motions < 2)
      return;
    SwitchingFit fit{candidate.start};
    iterate(in.all.transitions, in.prior(in.all), in.em(), candidate.iterations, fit);
    candidate.start = with_closest_tied(in, fit);
    candidate.name = "tied";
    validation.consider({candidate});
    if (validation.chosen().candidate.row != validation.last().candidate.row) return;
  }
}

}  // namespace modebank
