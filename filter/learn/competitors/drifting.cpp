#include "filter/learn/competitors/drifting.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "filter/judge/run/drifting.hpp"
#include "filter/learn/from_mixture/bank_frame.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/step/student_noise.hpp"
#include "ident/model/transitions.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

Eigen::VectorXd regressor_scale(const Recording& recording, const LinearStructure& structure) {
  const Transitions transitions = stack_training(unweighted_training_part(recording), structure);
  if (transitions.count() == 0) throw DataError("no training run has a transition to learn from");
  const Eigen::VectorXd scale =
      (transitions.regressors.colwise().squaredNorm() / static_cast<double>(transitions.count())).cwiseSqrt();
  return scale.unaryExpr([](double rms) { return rms > 0.0 ? rms : 1.0; });
}

namespace {

constexpr Index factors_below = 16, factors_above = 32;  // of the grid 2^(i / 4) of a horizon's factor

DriftingModel undecided_model(const Recording& recording, const GlobalModel& global, const LinearStructure& structure) {
  const Index n = structure.states;
  const Bank frame = bank_frame(recording, structure, Eigen::MatrixXd::Zero(n, n));
  DriftingModel model;
  model.structure = structure;
  model.state_names = frame.state_names;
  model.input_names = frame.input_names;
  model.dt_s = frame.dt_s;
  model.theta0 = global.theta;
  model.scale = regressor_scale(recording, structure);
  model.v0 = global.noise_variance().unaryExpr(&positive_variance);
  model.variance_floor = model.v0;
  model.quantum = recording.quantum;
  return model;
}

void take_own_variance(DriftingModel& model, const Recording& recording) {
  const DriftingGrid grid = coarse_drifting_grid();
  const DriftingScores scores = score_drifting_grid(model, recording, grid);
  const Index drift = scores.best() / (std::ssize(grid.lam) * std::ssize(grid.nu) * std::ssize(grid.floor));
  model.v0.array() *= scores.error_ratio.col(drift).array();
  model.v0 = model.v0.unaryExpr(&positive_variance);
}

/// Settings that may be better beyond the grid; a floor that the next one equals never mattered.
std::vector<std::string> grid_ends(const DriftingGrid& grid, const DriftingScores& scores, Index best) {
  const std::array<Index, 6> at = grid.point(best), size = grid.sizes();
  const auto last = [&](std::size_t i) { return size[i] > 1 && at[i] == size[i] - 1; };
  const auto first = [&](std::size_t i) { return size[i] > 1 && at[i] == 0; };
  std::vector<std::string> ends;
  if (last(0)) ends.emplace_back("q");
  if (last(1)) ends.emplace_back("p0");
  if (last(2)) ends.emplace_back("leak");
  if (first(3) || last(3)) ends.emplace_back("lam");
  double least = 0.0;  // of the degrees of freedom
  for (const double nu : grid.nu) least = nu > 0.0 && (least == 0.0 || nu < least) ? nu : least;
  if (size[4] > 1 && least > 0.0 && grid.nu[static_cast<std::size_t>(at[4])] == least) ends.emplace_back("nu");
  const bool binds = first(5) && scores.log_score(best) > scores.log_score(best + 1);
  if (binds || last(5)) ends.emplace_back("floor");
  return ends;
}

void settle(DriftingModel& model, const DriftingGrid& grid, const DriftingScores& scores) {
  const Index best = scores.best();
  const std::array<Index, 6> at = grid.point(best);
  const auto chosen = [&](const std::vector<double>& values, std::size_t i) {
    return values[static_cast<std::size_t>(at[i])];
  };
  model.rates = {chosen(grid.q, 0), chosen(grid.p0, 1), chosen(grid.leak, 2)};
  model.lam = chosen(grid.lam, 3);
  model.nu = chosen(grid.nu, 4);
  model.variance_floor = chosen(grid.floor, 5) * model.v0;
  model.tuning = {scores.log_score(best), scores.samples, grid_ends(grid, scores, best)};
}

std::vector<DriftingForecasts> training_forecasts(const DriftingModel& model, const Recording& recording,
                                                  const std::vector<Index>& horizons) {
  std::vector<const Trajectory*> runs;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) runs.push_back(&run);
  std::vector<DriftingForecasts> forecasts(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { forecasts[i] = forecast(model, *runs[i], horizons); });
  return forecasts;
}

/// The position in the grid of factors that makes the errors most likely, the nearest to 1 of equals.
Index best_factor(const StudentNoise& noise, const std::vector<DriftingForecasts>& runs, std::size_t horizon) {
  const auto gain = [&](Index i) {
    const double factor = std::exp2(0.25 * static_cast<double>(i));
    double sum = 0.0;
    for (const DriftingForecasts& run : runs)
      for (Index k = 0; k < run.whitened[horizon].cols(); ++k)
        if (!std::isnan(run.whitened[horizon](0, k))) sum += widening_gain(noise, run.whitened[horizon].col(k), factor);
    return sum;
  };
  Index best = 0;
  double most = 0.0;  // of factor 1
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

void choose_horizon_factors(DriftingModel& model, const Recording& recording, const std::vector<Index>& horizons) {
  const std::vector<DriftingForecasts> runs = training_forecasts(model, recording, horizons);
  if (runs.empty()) return;
  const std::vector<Index>& ascending = runs.front().predictions.horizons;
  const StudentNoise noise(model.nu);
  bool at_end = false;
  for (std::size_t h = 0; h < ascending.size(); ++h) {
    if (ascending[h] == 1) continue;
    const Index best = best_factor(noise, runs, h);
    at_end = at_end || best == -factors_below || best == factors_above;
    model.horizon_factor.emplace_back(ascending[h], std::exp2(0.25 * static_cast<double>(best)));
  }
  if (at_end) model.tuning.at_grid_end.emplace_back("horizon_factor");
}

}  // namespace

DriftingModel learn_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                             const std::vector<Index>& horizons, const DriftingGrid& grid, Wandering wandering) {
  DriftingModel model = undecided_model(recording, global, structure);
  model.wandering = wandering;
  if (wandering == Wandering::gain) take_own_variance(model, recording);
  settle(model, grid, score_drifting_grid(model, recording, grid));
  choose_horizon_factors(model, recording, horizons);
  return model;
}

DriftingModel relearn_drifting(const DriftingModel& like, const Recording& recording, const GlobalModel& global) {
  const DriftingModel own = undecided_model(recording, global, like.structure);
  DriftingModel model = like;
  model.theta0 = own.theta0;
  model.scale = own.scale;
  if (like.wandering == Wandering::gain) return model;  // whose variance is that of its own errors
  model.variance_floor = (like.variance_floor.array() / like.v0.array() * own.v0.array()).matrix();
  model.v0 = own.v0;
  return model;
}

}  // namespace modebank
