#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "filter/learn/competitors/drifting.hpp"
#include "filter/learn/likelihood/training_likelihood.hpp"
#include "filter/learn/refine/learning_part.hpp"

namespace modebank {
namespace {

using Eigen::Index;

/// Position of a setting on its grid, in the order q, p0, leak, lam, nu, floor, start. `start` is the running variance
/// at a start, as a share of v0.
using Point = std::array<std::size_t, 7>;

std::array<std::vector<double>, 7> grids() {
  const DriftingGrid grid;
  return {grid.q, {1e-2, 1e-1, 1.0, 10.0, 100.0}, grid.leak, grid.lam, grid.nu, grid.floor, {0.1, 0.3, 1.0}};
}

/// The training score, one sample ahead. `samples`: those that a filter of this structure scores.
GridTuning scored(const Bank& bank, const Recording& training, Index samples) {
  return {training_log_likelihood(bank, training, {}) / static_cast<double>(samples), samples};
}

Index scored_samples(const Bank& bank, const Recording& training) {
  Index samples = 0;
  for (const Trajectory& run : training.runs)
    if (run.role == Role::train) samples += (!log_densities(bank, run, {}).array().isNaN()).count();
  return samples;
}

/// Climbs along one setting after another to the highest training score.
class Climb {
 public:
  /// `frame`: a model with levels whose settings are ignored.
  Climb(const Bank& frame, const Recording& training, Index samples)
      : frame_(frame), training_(training), samples_(samples), grids_(grids()) {}

  void from(Point at) {
    constexpr double least_climb = 1e-5;  // [nats/sample]
    for (bool moved = true; moved;) {
      moved = false;
      for (std::size_t setting = 0; setting < at.size(); ++setting) {
        Point trial = at;
        for (trial[setting] = 0; trial[setting] < grids_[setting].size(); ++trial[setting])
          if (score(trial) > score(at) + least_climb) {
            at = trial;
            moved = true;
          }
      }
    }
    if (!best_ || score(at) > score(*best_)) best_ = at;
  }

  /// The best model of all climbs. P, q, the levels and the floor are in units of v, so a share of v0 at the start is
  /// the same as levels of this share.
  Bank best() const { return at(*best_); }

 private:
  const Bank& frame_;
  const Recording& training_;
  Index samples_;
  std::array<std::vector<double>, 7> grids_;
  std::map<Point, double> known_;
  std::optional<Point> best_;

  Bank at(const Point& point) const {
    const auto value = [&](std::size_t setting) { return grids_[setting][point[setting]]; };
    const double share = value(6);
    Bank bank = frame_;
    bank.drift.rates = {share * value(0), share * value(1), value(2)};
    bank.running_noise.lam = value(3);
    bank.running_noise.nu = value(4);
    bank.running_noise.floor = value(5) / share * bank.noise_variance();
    bank.running_noise.level *= share;
    return bank;
  }

  double score(const Point& point) {
    const auto [known, is_new] = known_.try_emplace(point, 0.0);
    if (!is_new) return known->second;
    const double log_score = scored(at(point), training_, samples_).log_score;
    return known->second = std::isnan(log_score) ? -std::numeric_limits<double>::infinity() : log_score;
  }
};

/// The largest part of the training runs whose climbs are affordable; 0: all.
Index affordable_transitions(const Bank& bank) {
  constexpr double most_products = 3e7;  // of one pass over the runs; two climbs take about 140 passes
  const double levels = static_cast<double>(bank.running_noise.levels()),
               regressors = static_cast<double>(bank.structure.regressors()),
               outputs = static_cast<double>(bank.structure.states);
  return static_cast<Index>(most_products / (levels * levels * regressors * regressors * outputs));
}

}  // namespace

Bank with_noise_levels(const Bank& drifting, const Bank& one_motion, const Recording& recording,
                       const std::vector<Index>& horizons) {
  constexpr Index fewest_transitions = 1000;
  constexpr double least_level = 1e-6;
  const Index n = drifting.structure.states;
  if (one_motion.mode_count() == 1) return drifting;
  Bank frame = drifting;
  frame.running_noise.level.resize(n, one_motion.mode_count());
  for (Index j = 0; j < one_motion.mode_count(); ++j)
    frame.running_noise.level.col(j) =
        (one_motion.modes[static_cast<std::size_t>(j)].Q.diagonal().head(n) + one_motion.R.diagonal())
            .cwiseQuotient(drifting.noise_variance())
            .cwiseMax(least_level);
  frame.running_noise.switching = one_motion.transition.matrix();
  const Index most = affordable_transitions(frame);
  if (most < fewest_transitions) return drifting;
  const std::optional<Recording> part = learning_part(recording, most, 1);
  const Recording& training = part ? *part : recording;
  const Index samples = scored_samples(frame, training);
  Climb climb(frame, training, samples);
  // q 1e-3, p0 10, no leak, Gaussian, the lowest floor, v0; a short and a long memory of the variance
  for (const std::size_t lam : {5, 7}) climb.from({3, 3, 0, lam, 0, 0, 2});
  Bank bank = climb.best();
  bank.drift.tuning = scored(bank, training, samples);
  if (!(bank.drift.tuning.log_score > scored(drifting, training, samples).log_score)) return drifting;
  choose_horizon_factors(bank, recording, horizons);
  return bank;
}

}  // namespace modebank
