#include "filter/refine_average.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "filter/refine_errors.hpp"
#include "filter/refine_fit.hpp"
#include "filter/refine_noise.hpp"
#include "filter/refine_start.hpp"
#include "filter/refined_modes.hpp"
#include "filter/united_bank.hpp"

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
Index members_worth_it(const Eigen::VectorXd& scores) {
  Index fewest = 0;
  while (!(scores(fewest) > scores.maxCoeff() - least_likelihood_gain) && fewest + 1 < scores.size()) ++fewest;
  return scores(fewest) > scores(0) ? fewest + 1 : 1;
}

/// One member, as it would be were it alone.
Bank member_bank(const AverageInput& in, const ScoredFit& scored, Index iterations) {
  const SwitchingPrior prior =
      switching_prior(in.transitions, in.fits.global, in.fits.prior_sd, scored.start.noise_transitions);
  TrainingFit fit = fit_training_runs(in.frame, scored.start, in.transitions, prior, in.options, iterations);
  Bank bank = with_modes(in.frame, fit.model);
  bank.screened = std::move(fit.screened);
  set_weights(fit.posterior.probability.transpose() * in.transitions.usable, bank);
  set_standard_errors(in.recording, sum_transitions(in.transitions, fit.posterior, prior), prior, scored.start.shared,
                      false, bank);
  return bank;
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

}  // namespace

void average_fits(const AverageInput& in, const CrossValidation& validation, Refinement& result) {
  if (!validation.possible()) return;
  const std::vector<ScoredFit> fits = validation.best_of_starts();
  const auto most = std::min(static_cast<std::size_t>(in.options.members), fits.size());
  const double switching = member_switching(in.recording);
  Eigen::VectorXd scores(static_cast<Index>(most));
  tbb::parallel_for(std::size_t{0}, most, [&](std::size_t i) {
    scores(static_cast<Index>(i)) =
        validation.score(i == 0 ? fits.front().banks : united_on_splits(fits, i + 1, switching));
  });
  const Index count = members_worth_it(scores);
  result.averaging = {count, scores(0), scores(count - 1)};
  if (count == 1) return;

  const auto members_count = static_cast<std::size_t>(count);
  std::vector<Bank> members(members_count);
  members[0] = result.bank;
  tbb::parallel_for(std::size_t{1}, members_count, [&](std::size_t i) {
    members[i] = member_bank(in, fits[i], result.candidates[fits[i].row].iterations);
  });
  for (std::size_t i = 0; i < members_count; ++i) result.candidates[fits[i].row].selected = true;
  result.bank = unite(members, switching);
  result.bank.screened = screened_of(members, in.frame.screened.size());
  result.bank.noise_adaptation = validation.adaptation(united_on_splits(fits, members_count, switching));
}

}  // namespace modebank
