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

/// The fit with drifting modes and its noise adaptation, scored on the left-out runs.
Fit tried(const CrossValidation& validation, Fit fit) {
  for (Bank& bank : fit.of_splits) bank = with_drift(bank, fit);
  fit.scores = validation.scores(fit.of_splits);
  return fit;
}

double total(const Fit& fit) { return fit.scores.log_likelihood.sum(); }

/// One setting: its grid and its position in the grid.
struct Coordinate {
  std::span<const double> grid;
  double& value;
};

/// Moves to better neighbours on each grid in turn until no neighbour is better. NaN is never better.
Fit climbed(const RefineInput& in, const CrossValidation& validation, const Fit& start) {
  const RefineTuning& tuning = refine_tuning;
  Fit best = tried(validation, start);
  Fit at = start;
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
          at = best;
          const std::ptrdiff_t next = std::find(c.grid.begin(), c.grid.end(), c.value) - c.grid.begin() + way;
          if (next < 0 || next >= std::ssize(c.grid)) break;
          c.value = c.grid[static_cast<std::size_t>(next)];
          Fit trial = tried(validation, at);
          if (!(total(trial) > total(best))) break;
          best = std::move(trial);
          moved = true;
        }
  }
  return best;
}

/// The chosen fit, and the best fit of every other number of modes.
std::vector<Fit> fits_to_try(const CrossValidation& validation, const Fit& constant, bool other_sizes) {
  std::vector<Fit> fits{constant};
  if (!other_sizes) return fits;
  for (Fit& fit : validation.best_of_each_size())
    if (fit.model.modes() != constant.model.modes()) fits.push_back(std::move(fit));
  return fits;
}

/// A start in the middle of the grids.
Fit start_of(Fit fit, const Eigen::VectorXd& scale) {
  const RefineTuning& tuning = refine_tuning;
  fit.drift = {{tuning.drift_rates[2], tuning.drift_starts[3], tuning.drift_leaks[0]}, scale};
  fit.adaptation = {tuning.drift_forgettings[4], tuning.drift_noise_prior_samples[3]};
  return fit;
}

/// Scores of the runs without drift, with the noise adaptation that is best without drift.
Eigen::VectorXd scores_without(const CrossValidation& validation, const Fit& constant) {
  std::vector<Bank> banks = constant.of_splits;
  const NoiseAdaptation adaptation = validation.adaptation(banks);
  for (Bank& bank : banks) bank.noise_adaptation = adaptation;
  return validation.scores(banks).log_likelihood;
}

}  // namespace

std::optional<Fit> choose_drift(const RefineInput& in, const CrossValidation& validation, const Fit& constant,
                                bool other_sizes, DriftStage& stage) {
  if (!validation.possible()) return std::nullopt;
  const Eigen::VectorXd scale = regressor_scale(in.recording, in.frame.structure);
  std::vector<Fit> sizes;
  std::vector<LeftOutScores> scores;
  for (const Fit& fit : fits_to_try(validation, constant, other_sizes)) {
    sizes.push_back(climbed(in, validation, start_of(fit, scale)));
    scores.push_back(sizes.back().scores);
  }
  const Fit& best = sizes[fewest_modes_as_good(scores, validation.samples(), refine_tuning)];
  const Eigen::VectorXd without = scores_without(validation, constant);
  const PairedLoss gain = paired_loss(best.scores.log_likelihood, without, validation.samples());
  const DriftRates& rates = best.drift.rates;
  stage.taken = is_worth_it(gain, validation.samples());
  stage.modes = best.scores.modes;
  stage.rate = rates.q;
  stage.start = rates.p0;
  stage.leak = rates.leak;
  stage.score_before = without.sum() / validation.samples().sum();
  stage.gain = gain.mean;
  stage.gain_standard_error = gain.standard_error;
  return stage.taken ? std::optional(best) : std::nullopt;
}

Bank with_drift(Bank bank, const Fit& fit) {
  bank.R.setZero();
  bank.drift = fit.drift;
  bank.noise_adaptation = fit.adaptation;
  return bank;
}

}  // namespace modebank
