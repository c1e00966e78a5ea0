// The competitor `drifting` (method: section 6): the scores of its settings, their choice, and its noise levels.
#include "filter/step/drifting.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "filter/judge/horizon.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/step/bank_filter.hpp"
#include "filter/step/noise_density.hpp"
#include "filter/step/samples.hpp"
#include "ident/base/work_counter.hpp"
#include "ident/model/transitions.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

struct TrainingRun {
  const Trajectory& trajectory;
  RunInstants instants;
};

/// Inputs of all running variances and densities for one (q, p0, leak): e^2 / (1 + h'Ph), divided by v0, of each scored
/// signal, by output. `restart`: the filter starts, and so does the running variance.
struct DriftTrace {
  static constexpr double restart = -1.0;
  std::vector<std::vector<double>> ratio;
  double log_variance = 0.0;  ///< sum of log (v0 (1 + h'Ph)) over all scored signals
  Index samples = 0;
};

DriftTrace trace_drift(Bank bank, const DriftRates& rates, const std::vector<TrainingRun>& runs) {
  bank.drift.rates = rates;
  const Eigen::VectorXd v0 = bank.noise_variance();
  DriftTrace trace{std::vector<std::vector<double>>(static_cast<std::size_t>(v0.size()))};
  DriftingFilter filter(bank);
  for (const TrainingRun& run : runs)
    for (Index t = 0; t < run.instants.count(); ++t) {
      const bool scored = !std::isnan(follow(run.instants, t, run.trajectory, filter));
      trace.samples += scored ? 1 : 0;
      for (Index i = 0; i < v0.size(); ++i) {
        std::vector<double>& ratio = trace.ratio[static_cast<std::size_t>(i)];
        if (run.instants.instants[static_cast<std::size_t>(t)].starts) ratio.push_back(DriftTrace::restart);
        const double e = filter.innovation()(i), growth = filter.growth(i);
        if (!scored || std::isnan(e)) continue;
        ratio.push_back(e * e / growth / v0(i));
        trace.log_variance += std::log(v0(i)) + std::log(growth);
      }
    }
  return trace;
}

/// Sums of log densities for all (lam, nu, floor), floor fastest. Running variances of all (lam, floor) are in units of
/// v0.
void score_trace(const DriftTrace& trace, const DriftingGrid& grid, Eigen::Ref<Eigen::VectorXd> sums) {
  const Index floors = std::ssize(grid.floor), pairs = std::ssize(grid.lam) * floors;
  Eigen::ArrayXd floor(pairs), keep(pairs), v(pairs), square(pairs), log_variance = Eigen::ArrayXd::Zero(pairs);
  for (Index i = 0; i < pairs; ++i) {
    floor(i) = grid.floor[static_cast<std::size_t>(i % floors)];
    keep(i) = grid.lam[static_cast<std::size_t>(i / floors)];
  }
  const std::vector<StudentNoise> noises(grid.nu.begin(), grid.nu.end());
  // per nu: sums of log (1 + z^2 / (nu - 2)); of z^2 for the normal distribution
  Eigen::ArrayXXd tail = Eigen::ArrayXXd::Zero(pairs, std::ssize(noises));
  double signals = 0.0;
  for (const std::vector<double>& of_output : trace.ratio)
    for (const double ratio : of_output) {
      if (ratio == DriftTrace::restart) {
        v.setOnes();
        continue;
      }
      square = ratio / v;
      log_variance += v.log();
      for (Index d = 0; const StudentNoise& noise : noises) {
        if (noise.gaussian())
          tail.col(d++) += square;
        else
          tail.col(d++) += (1.0 + square / (noise.degrees() - 2.0)).log();
      }
      v = (keep * v + (1.0 - keep) * ratio).max(floor);
      ++signals;
    }
  for (Index d = 0; const StudentNoise& noise : noises) {
    const double weight = noise.gaussian() ? 0.5 : 0.5 * (noise.degrees() + 1.0);
    const Eigen::ArrayXd sum = signals * noise.log_constant() - 0.5 * log_variance - weight * tail.col(d);
    for (Index i = 0; i < pairs; ++i) sums((i / floors * tail.cols() + d) * floors + i % floors) = sum(i);
    ++d;
  }
  sums.array() -= 0.5 * trace.log_variance;
}

}  // namespace

std::array<double, 6> DriftingGrid::point(Index index) const {
  const std::array settings{&q, &p0, &leak, &lam, &nu, &floor};
  std::array<double, 6> at{};
  for (std::size_t i = settings.size(); i-- > 0; index /= std::ssize(*settings[i]))
    at[i] = (*settings[i])[static_cast<std::size_t>(index % std::ssize(*settings[i]))];
  return at;
}

Index DriftingScores::best() const { return std::ranges::max_element(log_score, is_below) - log_score.begin(); }

DriftingScores score_drifting_grid(const Bank& start, const Recording& recording, const DriftingGrid& grid) {
  const Index drifts = std::ssize(grid.q) * std::ssize(grid.p0) * std::ssize(grid.leak),
              rest = std::ssize(grid.lam) * std::ssize(grid.nu) * std::ssize(grid.floor);
  if (drifts * rest == 0) throw std::invalid_argument("the drifting model's grid has a setting without values");
  std::vector<TrainingRun> runs;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    check_run(start, run);
    runs.push_back({run, RunInstants(start, run)});
  }
  DriftingScores scores{Eigen::VectorXd(drifts * rest), 0};
  WorkCounter counter("settings of the drifting model", static_cast<std::size_t>(drifts));
  tbb::parallel_for(Index{0}, drifts, [&](Index d) {
    counter.add();
    const std::array<double, 6> at = grid.point(d * rest);
    const DriftTrace trace = trace_drift(start, {at[0], at[1], at[2]}, runs);
    score_trace(trace, grid, scores.log_score.segment(d * rest, rest));
    if (d == 0) scores.samples = trace.samples;
  });
  if (scores.samples == 0) throw DataError("no training run has a sample on which a drifting model can be scored");
  scores.log_score /= static_cast<double>(scores.samples);
  return scores;
}

namespace {

/// The model with theta0, v0 and the root mean squares of the regressors, whose other settings are to be chosen.
Bank undecided_bank(const Recording& recording, const GlobalModel& global, const LinearStructure& structure) {
  const Transitions transitions = stack_training(recording, structure);
  require_transitions(transitions.count() > 0);
  const Eigen::VectorXd scale =
      (transitions.regressors.colwise().squaredNorm() / static_cast<double>(transitions.count())).cwiseSqrt();
  Bank bank = one_mode_bank(structure, global.theta, global.noise_variance().unaryExpr(&positive_variance));
  bank.model = "varx";
  bank.state_names = state_names(recording, structure);
  bank.input_names = input_names(recording, structure);
  bank.dt_s = training_part(recording).median_period_s();
  bank.drift.scale = scale.unaryExpr([](double rms) { return rms > 0.0 ? rms : 1.0; });
  bank.running_noise.floor = bank.noise_variance();
  bank.quantum = recording.quantum;
  return bank;
}

/// The bank with these values of q, p0, leak, lam, nu, floor, and of the running variance at a start as a share of v0.
/// P, q, the levels and the floor are in units of v, so such a share is the same as levels of this share.
Bank with_settings(Bank bank, const std::array<double, 6>& at, double share = 1.0) {
  bank.drift.rates = {share * at[0], share * at[1], at[2]};
  bank.running_noise.lam = at[3];
  bank.running_noise.nu = at[4];
  bank.running_noise.floor = at[5] / share * bank.noise_variance();
  bank.running_noise.level *= share;
  return bank;
}

/// Chooses the variance's factor of each horizon from 2 on, as learn_drifting. If several are equally likely, the
/// nearest to factor 1.
void choose_horizon_factors(Bank& bank, const Recording& recording, const std::vector<Index>& asked) {
  constexpr Index below = 16, above = 32;
  bank.running_noise.horizon_factor.clear();
  std::set<Index> ordered(asked.begin(), asked.end());
  ordered.erase(1);
  if (ordered.empty()) return;
  const std::vector<Index> horizons(ordered.begin(), ordered.end());
  const std::vector<Trajectory> runs = training_part(recording).runs;
  std::vector<std::vector<LevelErrors>> errors(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { errors[i] = level_errors(bank, runs[i], horizons); });
  const StudentNoise noise(bank.running_noise.nu);
  for (std::size_t h = 0; h < horizons.size(); ++h) {
    double best = 1.0, most = 0.0;  // factor, and what it adds to the log density
    for (Index away = 1; away <= above; ++away)
      for (const Index i : {away, -away}) {
        if (i < -below) continue;
        const double factor = std::exp2(0.25 * static_cast<double>(i));
        double gain = 0.0;
        for (const std::vector<LevelErrors>& run : errors)
          for (Index k = 0; k < run[h].whitened.cols(); ++k)
            if (!std::isnan(run[h].whitened(0, k))) gain += run[h].widening_gain(noise, k, factor);
        if (!(gain > most)) continue;
        most = gain;
        best = factor;
      }
    bank.running_noise.horizon_factor.emplace_back(horizons[h], best);
  }
}

}  // namespace

Bank learn_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                    const std::vector<Index>& horizons, const DriftingGrid& grid) {
  Bank bank = undecided_bank(recording, global, structure);
  const DriftingScores scores = score_drifting_grid(bank, recording, grid);
  bank = with_settings(bank, grid.point(scores.best()));
  bank.running_noise.floor = bank.running_noise.floor.cwiseMax(bank.rounding_variance());
  bank.drift.tuning = {scores.log_score(scores.best()), scores.samples};
  choose_horizon_factors(bank, recording, horizons);
  return bank;
}

Bank relearn_drifting(const Bank& like, const Recording& recording, const GlobalModel& global) {
  const Bank own = undecided_bank(recording, global, like.structure);
  Bank bank = like;
  bank.modes.front().model = own.modes.front().model;
  bank.modes.front().Q = own.modes.front().Q;
  bank.drift.scale = own.drift.scale;
  bank.running_noise.floor.array() *= own.noise_variance().array() / like.noise_variance().array();
  return bank;
}

namespace {

/// The training score, one sample ahead. `samples`: those that a filter of this structure scores.
GridTuning scored(const Bank& bank, const Recording& training, Index samples) {
  return {training_log_likelihood(bank, training, {}) / static_cast<double>(samples), samples};
}

using Point = std::array<std::size_t, 7>;  ///< positions of the settings of with_settings on their grids

/// The best model that climbs along one setting after another find, by the training score. `frame`: a model with levels
/// whose settings are ignored.
Bank climb(const Bank& frame, const Recording& training, Index samples, const std::vector<Point>& starts) {
  constexpr double least_climb = 1e-5;  // [nats/sample]
  const DriftingGrid g;
  const std::array<std::vector<double>, 7> grids{
      g.q, {1e-2, 1e-1, 1.0, 10.0, 100.0}, g.leak, g.lam, g.nu, g.floor, {0.1, 0.3, 1.0}};
  const auto model = [&](const Point& at) {
    std::array<double, 6> values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = grids[i][at[i]];
    return with_settings(frame, values, grids[6][at[6]]);
  };
  std::map<Point, double> known;
  const auto score = [&](const Point& at) {
    const auto [entry, is_new] = known.try_emplace(at, -std::numeric_limits<double>::infinity());
    if (is_new) entry->second = std::fmax(entry->second, scored(model(at), training, samples).log_score);  // not NaN
    return entry->second;
  };
  Point best = starts.front();
  for (Point at : starts) {
    for (bool moved = true; moved;) {
      moved = false;
      for (std::size_t setting = 0; setting < at.size(); ++setting) {
        Point trial = at;
        for (trial[setting] = 0; trial[setting] < grids[setting].size(); ++trial[setting])
          if (score(trial) > score(at) + least_climb) {
            at = trial;
            moved = true;
          }
      }
    }
    if (score(at) > score(best)) best = at;
  }
  return model(best);
}

}  // namespace

Bank with_noise_levels(const Bank& drifting, const Bank& one_motion, const Recording& recording,
                       const std::vector<Index>& horizons) {
  constexpr Index fewest_transitions = 1000;
  constexpr double most_products = 3e7;  // of one pass over the training part; two climbs take about 140 passes
  constexpr double least_level = 1e-6;
  if (one_motion.mode_count() == 1) return drifting;
  const Index n = drifting.structure.states, levels = one_motion.mode_count();
  Bank frame = drifting;
  frame.running_noise.level.resize(n, levels);
  for (Index j = 0; j < levels; ++j) {
    const Eigen::VectorXd Q = one_motion.modes[static_cast<std::size_t>(j)].Q.diagonal().head(n);
    frame.running_noise.level.col(j) =
        (Q + one_motion.R.diagonal()).cwiseQuotient(drifting.noise_variance()).cwiseMax(least_level);
  }
  frame.running_noise.switching = one_motion.transition.matrix();
  const Index r = drifting.structure.regressors();
  const auto most = static_cast<Index>(most_products / static_cast<double>(levels * levels * r * r * n));
  if (most < fewest_transitions) return drifting;
  const std::optional<Recording> part = learning_part(recording, most, 1);
  const Recording& training = part ? *part : recording;
  Index samples = 0;
  for (const Trajectory& run : training.runs)
    if (run.role == Role::train) samples += (!log_densities(frame, run, {}).array().isNaN()).count();
  // q 1e-3, p0 10, no leak, Gaussian, the lowest floor, v0; a short and a long memory of the variance
  Bank bank = climb(frame, training, samples, {{3, 3, 0, 5, 0, 0, 2}, {3, 3, 0, 7, 0, 0, 2}});
  bank.drift.tuning = scored(bank, training, samples);
  if (!(bank.drift.tuning.log_score > scored(drifting, training, samples).log_score)) return drifting;
  choose_horizon_factors(bank, recording, horizons);
  return bank;
}

}  // namespace modebank
