// The competitor `drifting`: its settings, what drifts, and its noise levels.
#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "filter/judge/horizon.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/step/noise_density.hpp"
#include "ident/data/stretch.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/model/transitions.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// Root mean square of every regressor over the training transitions, with equal weights; 1 if a regressor is always
/// zero.
Eigen::VectorXd regressor_scale(const Recording& recording, const LinearStructure& structure) {
  const Transitions transitions = stack_training(recording, structure);
  require_transitions(transitions.count() > 0);
  const Eigen::VectorXd scale =
      (transitions.regressors.colwise().squaredNorm() / static_cast<double>(transitions.count())).cwiseSqrt();
  return scale.unaryExpr([](double rms) { return rms > 0.0 ? rms : 1.0; });
}

constexpr Index factors_below = 16, factors_above = 32;  // index of the grid 2^(i / 4) of a horizon's factor

Bank undecided_bank(const Recording& recording, const GlobalModel& global, const LinearStructure& structure) {
  const Index n = structure.states;
  const Bank frame = bank_frame(recording, structure, Eigen::MatrixXd::Zero(n, n));
  Bank bank = one_mode_bank(structure, global.theta, global.noise_variance().unaryExpr(&positive_variance));
  bank.model = "varx";
  bank.state_names = frame.state_names;
  bank.input_names = frame.input_names;
  bank.dt_s = frame.dt_s;
  bank.drift.scale = regressor_scale(recording, structure);
  bank.running_noise.floor = bank.noise_variance();
  bank.quantum = recording.quantum;
  return bank;
}

void take_own_variance(Bank& bank, const Recording& recording) {
  const DriftingGrid grid = coarse_drifting_grid();
  const DriftingScores scores = score_drifting_grid(bank, recording, grid);
  const Index drift = scores.best() / (std::ssize(grid.lam) * std::ssize(grid.nu) * std::ssize(grid.floor));
  bank.noise_variance().array() *= scores.error_ratio.col(drift).array();
  bank.noise_variance() = bank.noise_variance().unaryExpr(&positive_variance).eval();
}

void settle(Bank& bank, const DriftingGrid& grid, const DriftingScores& scores) {
  const Index best = scores.best();
  const std::array<Index, 6> at = grid.point(best);
  const auto chosen = [&](const std::vector<double>& values, std::size_t i) {
    return values[static_cast<std::size_t>(at[i])];
  };
  bank.drift.rates = {chosen(grid.q, 0), chosen(grid.p0, 1), chosen(grid.leak, 2)};
  bank.running_noise.lam = chosen(grid.lam, 3);
  bank.running_noise.nu = chosen(grid.nu, 4);
  bank.running_noise.floor = (chosen(grid.floor, 5) * bank.noise_variance()).cwiseMax(bank.rounding_variance());
  bank.drift.tuning = {scores.log_score(best), scores.samples};
}

/// Errors of predictions per training run and horizon.
using TrainingErrors = std::vector<std::vector<LevelErrors>>;

/// The grid position of the factor that makes the errors most likely. If several are equally likely, the nearest to
/// factor 1.
Index best_factor(const StudentNoise& noise, const TrainingErrors& runs, std::size_t horizon) {
  const auto gain = [&](Index i) {
    const double factor = std::exp2(0.25 * static_cast<double>(i));
    double sum = 0.0;
    for (const std::vector<LevelErrors>& run : runs)
      for (Index k = 0; k < run[horizon].whitened.cols(); ++k)
        if (!std::isnan(run[horizon].whitened(0, k))) sum += run[horizon].widening_gain(noise, k, factor);
    return sum;
  };
  Index best = 0;
  double most = 0.0;  // log density with factor 1
  for (Index away = 1; away <= factors_above; ++away)
    for (const Index i : {away, -away}) {
      if (i < -factors_below) continue;
      if (const double value = gain(i); value > most) {
        most = value;
        best = i;
      }
    }
  return best;
}

/// Chooses the variance's factor of each horizon from 2 on, as learn_drifting.
void choose_horizon_factors(Bank& bank, const Recording& recording, std::vector<Index> horizons) {
  bank.running_noise.horizon_factor.clear();
  std::erase(horizons, Index{1});
  std::sort(horizons.begin(), horizons.end());
  horizons.erase(std::unique(horizons.begin(), horizons.end()), horizons.end());
  if (horizons.empty()) return;
  const std::vector<Trajectory> runs = training_part(recording).runs;
  TrainingErrors errors(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { errors[i] = level_errors(bank, runs[i], horizons); });
  const StudentNoise noise(bank.running_noise.nu);
  for (std::size_t h = 0; h < horizons.size(); ++h)
    bank.running_noise.horizon_factor.emplace_back(
        horizons[h], std::exp2(0.25 * static_cast<double>(best_factor(noise, errors, h))));
}

}  // namespace

Bank learn_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                    const std::vector<Index>& horizons, const DriftingGrid& grid, Wandering wandering) {
  Bank bank = undecided_bank(recording, global, structure);
  bank.drift.wandering = wandering;
  if (wandering == Wandering::gain) take_own_variance(bank, recording);
  settle(bank, grid, score_drifting_grid(bank, recording, grid));
  choose_horizon_factors(bank, recording, horizons);
  return bank;
}

Bank relearn_drifting(const Bank& like, const Recording& recording, const GlobalModel& global) {
  const Bank own = undecided_bank(recording, global, like.structure);
  Bank bank = like;
  bank.modes.front().model = own.modes.front().model;
  bank.drift.scale = own.drift.scale;
  if (like.drift.wandering == Wandering::gain) return bank;  // the variance of this model comes from its own errors
  const Eigen::ArrayXd share = like.running_noise.floor.array() / like.noise_variance().array();
  bank.running_noise.floor = share * own.noise_variance().array();
  bank.modes.front().Q = own.modes.front().Q;
  return bank;
}

namespace {

constexpr Index most_asked_transitions = 20000;
constexpr double least_wandering_gain = 0.02;  // [nats/sample]

struct Wanderer {
  LinearStructure structure;
  Wandering wandering;
};

/// The candidates. The first one is kept if no other candidate gains.
std::vector<Wanderer> candidates_of(const LinearStructure& structure) {
  const LinearStructure one_lag = structure.with_one_lag();
  std::vector<Wanderer> candidates{{structure, Wandering::all}};
  if (one_lag != structure) candidates.push_back({one_lag, Wandering::all});
  for (const Wanderer& with : std::vector<Wanderer>(candidates)) {
    LinearStructure constant = with.structure;
    constant.intercept = true;
    candidates.push_back({constant, Wandering::constant});
    if (with.structure.inputs > 0) candidates.push_back({with.structure, Wandering::gain});
  }
  return candidates;
}

}  // namespace

DriftingGrid coarse_drifting_grid() {
  return {{0.0, 1e-4, 1e-3, 1e-2}, {0.0, 1e-2, 1.0}, {1.0, 0.97}, {0.7, 0.85, 0.93, 0.97}, {0.0, 4.0, 10.0}, {1e-3}};
}

double drifting_training_score(const Recording& recording, Index latest, const LinearStructure& structure,
                               const DriftingGrid& grid, Wandering wandering) {
  const Recording part = from_common_start(recording, latest - structure.first_transition());
  try {
    return learn_drifting(part, fit_global(part, structure), structure, {1}, grid, wandering).drift.tuning.log_score;
  } catch (const DataError&) {
    return -std::numeric_limits<double>::infinity();
  }
}

Bank learn_likeliest_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                              const std::vector<Index>& horizons) {
  const std::optional<Recording> fewer = learning_part(recording, most_asked_transitions, 1);
  const std::vector<Wanderer> candidates = candidates_of(structure);
  const Wanderer* chosen = &candidates.front();
  DriftingGrid grid = coarse_drifting_grid();
  grid.p0.push_back(10.0);  // each run learns its own coefficients, so differences between runs do not change this
                            // comparison
  double best = -std::numeric_limits<double>::infinity();
  for (const Wanderer& candidate : candidates) {
    const double score = drifting_training_score(fewer ? *fewer : recording, structure.first_transition(),
                                                 candidate.structure, grid, candidate.wandering);
    if (!(score > best)) continue;
    best = &candidate == &candidates.front() ? score + least_wandering_gain : score;
    chosen = &candidate;
  }
  if (chosen == &candidates.front()) return learn_drifting(recording, global, structure, horizons);
  return learn_drifting(recording, fit_global(recording, chosen->structure), chosen->structure, horizons, {},
                        chosen->wandering);
}

namespace {

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
