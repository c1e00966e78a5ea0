#include "filter/learn/competitors/drifting.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "filter/judge/forecast.hpp"
#include "filter/learn/from_mixture/bank_frame.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/step/noise_density.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

Eigen::VectorXd regressor_scale(const Recording& recording, const LinearStructure& structure) {
  const Transitions transitions = stack_training(recording, structure);
  require_transitions(transitions.count() > 0);
  const Eigen::VectorXd scale =
      (transitions.regressors.colwise().squaredNorm() / static_cast<double>(transitions.count())).cwiseSqrt();
  return scale.unaryExpr([](double rms) { return rms > 0.0 ? rms : 1.0; });
}

namespace {

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

/// Per training run and horizon.
using TrainingErrors = std::vector<std::vector<LevelErrors>>;

TrainingErrors training_errors(const Bank& bank, const Recording& recording, const std::vector<Index>& horizons) {
  std::vector<const Trajectory*> runs;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) runs.push_back(&run);
  TrainingErrors errors(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { errors[i] = level_errors(bank, *runs[i], horizons); });
  return errors;
}

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

}  // namespace

void choose_horizon_factors(Bank& bank, const Recording& recording, std::vector<Index> horizons) {
  bank.running_noise.horizon_factor.clear();
  std::erase(horizons, Index{1});
  std::sort(horizons.begin(), horizons.end());
  horizons.erase(std::unique(horizons.begin(), horizons.end()), horizons.end());
  if (horizons.empty()) return;
  const TrainingErrors runs = training_errors(bank, recording, horizons);
  const StudentNoise noise(bank.running_noise.nu);
  for (std::size_t h = 0; h < horizons.size(); ++h)
    bank.running_noise.horizon_factor.emplace_back(horizons[h],
                                                   std::exp2(0.25 * static_cast<double>(best_factor(noise, runs, h))));
}

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

}  // namespace modebank
