#include "filter/learn/refine/averaging.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>
#include <utility>

namespace modebank {
namespace {

/// Once in a run of mean length.
double member_switching(const Recording& recording) {
  Index runs = 0;
  for (const Trajectory& run : recording.runs) runs += run.role == Role::train && run.transitions() > 0 ? 1 : 0;
  const Index transitions = recording.transitions(Role::train);
  return static_cast<double>(runs) / static_cast<double>(std::max(transitions, 2 * runs));
}

/// The first `count` fits united, one bank per split.
std::vector<Bank> united_on_splits(const std::vector<ScoredFit>& fits, std::size_t count, double switching) {
  std::vector<Bank> united;
  for (std::size_t s = 0; s < fits.front().banks.size(); ++s) {
    std::vector<Bank> members;
    for (std::size_t i = 0; i < count; ++i) members.push_back(fits[i].banks[s]);
    united.push_back(unite(members, switching));
  }
  return united;
}

/// How many of the fits to average: the fewest whose score is as good as the best number's. scores: of 1, 2, ... fits.
Index fewest_as_good(const Eigen::VectorXd& scores, double margin) {
  Index fewest = 0;
  while (!(scores(fewest) > scores.maxCoeff() - margin) && fewest + 1 < scores.size()) ++fewest;
  return scores(fewest) > scores(0) ? fewest + 1 : 1;
}

Bank member_bank(const RefineInput& in, const ScoredFit& scored, const NoiseAdaptation& adaptation) {
  const SwitchingPrior prior = in.prior(scored.start);
  const TrainingFit fit = fit_training_runs(in, scored.start, prior, scored.iterations);
  return with_errors(in, fit, prior, false, exact_filter(in.filter), bank_of_fit(in, fit, adaptation));
}

/// The modes that the members lost, said of which; what the mixture's bank had lost stands there once.
std::vector<ScreenedMode> screened_of(const std::vector<Bank>& members, std::size_t before) {
  std::vector<ScreenedMode> all = members.front().screened;
  all.resize(before);
  for (std::size_t i = 0; i < members.size(); ++i)
    for (std::size_t j = before; j < members[i].screened.size(); ++j) {
      all.push_back(members[i].screened[j]);
      all.back().reason += fmt::format(", in fit {}", i + 1);
    }
  return all;
}

/// pi' = pi' T, sum 1. Where several are, as for modes that never switch, that of a few switches to any mode.
Eigen::VectorXd long_run_share(const Eigen::MatrixXd& T) {
  constexpr double ergodic = 1e-9;
  const Index K = T.rows();
  Eigen::MatrixXd equations = ((1.0 - ergodic) * T.transpose()).array() + ergodic / static_cast<double>(K);
  equations.diagonal().array() -= 1.0;
  equations.row(K - 1).setOnes();
  const Eigen::VectorXd share = equations.partialPivLu().solve(Eigen::VectorXd::Unit(K, K - 1)).cwiseMax(0.0);
  return share / share.sum();
}

/// The members' modes, one after the other.
void append_modes(const Bank& member, double share, Bank& bank) {
  for (Mode mode : member.modes) {
    mode.weight *= share;
    bank.modes.push_back(std::move(mode));
  }
}

}  // namespace

Bank unite(const std::vector<Bank>& members, double switching) {
  if (members.empty()) throw std::invalid_argument("no bank to unite");
  const double share = 1.0 / static_cast<double>(members.size());
  Bank bank = members.front();
  bank.modes.clear();
  for (const Bank& member : members) append_modes(member, share, bank);
  const Index K = bank.mode_count();
  Eigen::MatrixXd within = Eigen::MatrixXd::Zero(K, K), errors = within;
  Eigen::VectorXd entry(K);
  bool have_errors = true;
  bank.initial_probability.resize(K);
  Index at = 0;
  for (const Bank& member : members) {
    const Index k = member.mode_count();
    within.block(at, at, k, k) = member.transition.matrix();
    entry.segment(at, k) = share * long_run_share(member.transition.matrix());
    bank.initial_probability.segment(at, k) = share * member.initial_probability;
    have_errors = have_errors && member.transition_standard_error.rows() == k;
    if (have_errors) errors.block(at, at, k, k) = (1.0 - switching) * member.transition_standard_error;
    at += k;
  }
  bank.transition = TransitionMatrix(((1.0 - switching) * within).rowwise() + switching * entry.transpose());
  if (have_errors) bank.transition_standard_error = errors;
  return bank;
}

AveragedBank average_fits(const RefineInput& in, const CrossValidation& validation, const Bank& one_fit) {
  if (!validation.possible()) return {};
  const std::vector<ScoredFit> fits = validation.best_of_starts();
  const auto most = std::min(static_cast<std::size_t>(in.options.members), fits.size());
  const double switching = member_switching(in.recording);
  Eigen::VectorXd scores(static_cast<Index>(most));
  tbb::parallel_for(std::size_t{0}, most, [&](std::size_t i) {
    scores(static_cast<Index>(i)) =
        validation.score(i == 0 ? fits.front().banks : united_on_splits(fits, i + 1, switching));
  });
  const Index count = fewest_as_good(scores, in.options.tuning.least_gain);
  AveragedBank result{{count, scores(0), scores(count - 1)}, std::nullopt, {}};
  if (count == 1) return result;

  std::vector<Bank> members(static_cast<std::size_t>(count));
  tbb::parallel_for(std::size_t{0}, members.size(), [&](std::size_t i) {
    members[i] = fits[i].row == validation.chosen().row ? one_fit : member_bank(in, fits[i], one_fit.noise_adaptation);
  });
  for (std::size_t i = 0; i < members.size(); ++i) result.rows.push_back(fits[i].row);
  result.bank = unite(members, switching);
  result.bank->screened = screened_of(members, in.frame.screened.size());
  result.bank->shrinking = std::max_element(members.begin(), members.end(), [](const Bank& a, const Bank& b) {
                             return a.shrinking.share < b.shrinking.share;
                           })->shrinking;
  result.of_splits = united_on_splits(fits, members.size(), switching);
  result.bank->noise_adaptation = validation.adaptation(result.of_splits);
  for (Bank& bank : result.of_splits) bank.noise_adaptation = result.bank->noise_adaptation;
  return result;
}

}  // namespace modebank
