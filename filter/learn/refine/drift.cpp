#include "filter/learn/refine/drift.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "filter/learn/competitors/drifting.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/tuning.hpp"

namespace modebank {
namespace {

/// Settings on their grids, and how the runs left out like them.
struct DriftTrial {
  DriftChoice choice;
  LeftOutScores scores;

  double total() const { return scores.log_likelihood.sum(); }
};

DriftTrial tried(const CrossValidation& validation, const DriftChoice& choice) {
  std::vector<Bank> banks;
  for (const Bank& bank : choice.fit.banks) banks.push_back(with_drift(bank, choice));
  return {choice, validation.scores(banks)};
}

/// One setting: its grid, and where it stands.
struct Coordinate {
  std::span<const double> grid;
  double& value;
};

/// Goes to better neighbours on every grid in turn until there are none. A score that is no number is never better.
DriftTrial climbed(const RefineInput& in, const CrossValidation& validation, const DriftChoice& start) {
  const RefineTuning& tuning = refine_tuning;
  DriftTrial best = tried(validation, start);
  DriftChoice at = start;
  std::vector<Coordinate> coordinates{{tuning.drift_rates, at.drift.rates.q},
                                      {tuning.drift_starts, at.drift.rates.p0},
                                      {tuning.drift_leaks, at.drift.rates.leak}};
  if (in.filter.noise == FilterNoise::adaptive) {
    coordinates.push_back({tuning.drift_forgettings, at.adaptation.forgetting});
    coordinates.push_back({tuning.drift_noise_prior_samples, at.adaptation.prior_samples});
  }
  for (bool moved = true; moved;) {
    moved = false;
    for (const Coordinate& c : coordinates)
      for (const std::ptrdiff_t way : {-1, 1})
        for (;;) {
          at = best.choice;
          const std::ptrdiff_t next = std::find(c.grid.begin(), c.grid.end(), c.value) - c.grid.begin() + way;
          if (next < 0 || next >= std::ssize(c.grid)) break;
          c.value = c.grid[static_cast<std::size_t>(next)];
          DriftTrial trial = tried(validation, at);
          if (!(trial.total() > best.total())) break;
          best = std::move(trial);
          moved = true;
        }
  }
  return best;
}

/// The chosen fit, and the best one of every other number of modes.
std::vector<ScoredFit> fits_to_try(const CrossValidation& validation, const ScoredFit& steady, bool other_sizes) {
  std::vector<ScoredFit> fits{steady};
  if (!other_sizes) return fits;
  for (ScoredFit& fit : validation.best_of_each_size())
    if (fit.start.model.modes() != steady.start.model.modes()) fits.push_back(std::move(fit));
  return fits;
}

/// From the middle of the grids.
DriftChoice start_of(const ScoredFit& fit, const Eigen::VectorXd& scale) {
  const RefineTuning& tuning = refine_tuning;
  return {fit,
          {{tuning.drift_rates[2], tuning.drift_starts[3], tuning.drift_leaks[0]}, scale},
          {tuning.drift_forgettings[4], tuning.drift_noise_prior_samples[3]}};
}

/// The runs' scores without drift, the noise scale moving as is best for that.
Eigen::VectorXd scores_without(const CrossValidation& validation, const ScoredFit& steady) {
  std::vector<Bank> banks = steady.banks;
  const NoiseAdaptation adaptation = validation.adaptation(banks);
  for (Bank& bank : banks) bank.noise_adaptation = adaptation;
  return validation.scores(banks).log_likelihood;
}

}  // namespace

std::optional<DriftChoice> choose_drift(const RefineInput& in, const CrossValidation& validation,
                                        const ScoredFit& steady, bool other_sizes, DriftStage& stage) {
  if (!validation.possible()) return std::nullopt;
  const Eigen::VectorXd scale = regressor_scale(in.recording, in.frame.structure);
  std::vector<DriftTrial> sizes;
  std::vector<LeftOutScores> scores;
  for (const ScoredFit& fit : fits_to_try(validation, steady, other_sizes)) {
    sizes.push_back(climbed(in, validation, start_of(fit, scale)));
    scores.push_back(sizes.back().scores);
  }
  const DriftTrial& best = sizes[fewest_modes_as_good(scores, validation.samples(), refine_tuning)];
  const Eigen::VectorXd without = scores_without(validation, steady);
  const PairedLoss gain = paired_loss(best.scores.log_likelihood, without, validation.samples());
  const DriftRates& rates = best.choice.drift.rates;
  stage.taken = is_worth_it(gain, validation.samples());
  stage.modes = best.scores.modes;
  stage.rate = rates.q;
  stage.start = rates.p0;
  stage.leak = rates.leak;
  stage.score_before = without.sum() / validation.samples().sum();
  stage.gain = gain.mean;
  stage.gain_standard_error = gain.standard_error;
  return stage.taken ? std::optional(best.choice) : std::nullopt;
}

Bank with_drift(Bank bank, const DriftChoice& choice) {
  bank.R.setZero();
  bank.drift = choice.drift;
  bank.noise_adaptation = choice.adaptation;
  return bank;
}

}  // namespace modebank
