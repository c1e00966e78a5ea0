#include "ident/lag/cross_validation.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "ident/base/linalg.hpp"
#include "ident/base/log_two_pi.hpp"
#include "ident/base/work_counter.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/lag/objective.hpp"

namespace modebank {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t most_folds = 10;
constexpr std::size_t corrections = EnumNames<LagCorrection>::values.size();

/// Sums over one left-out run.
struct RunScore {
  double log_density = 0.0, square_sum = 0.0;
  Index transitions = 0;
};

/// Scores the one-step predictions of `run` between two times.
RunScore score(const Trajectory& run, const GlobalModel& global, const LinearStructure& structure, double first_s,
               double last_s) {
  RunScore result;
  const LinearModel model = unpack(structure, global.theta);
  constexpr double least_variance = 1e-200;  // keeps logarithms finite for noise-free data
  const Index n = structure.states;
  const Cholesky noise(global.residual_covariance + least_variance * MatrixXd::Identity(n, n));
  const MatrixXd L = noise.L();
  const double log_constant =
      -static_cast<double>(structure.states) * 0.5 * log_two_pi - L.diagonal().array().log().sum();
  for (Index k = 0; k < run.transitions(); ++k) {
    if (run.time_s(k) < first_s || run.time_s(k + 1) > last_s) continue;
    const VectorXd error = run.state.col(k + 1) - model.next(run.state.col(k), run.input.col(k));
    if (!error.allFinite()) continue;
    result.log_density += log_constant - 0.5 * noise.whiten(error).squaredNorm();
    result.square_sum += error.squaredNorm();
    ++result.transitions;
  }
  return result;
}

/// Scores of all runs of one fold for every correction, ordered by run, then by correction.
std::vector<std::vector<RunScore>> score_fold(const std::vector<LagSubject>& subjects, std::size_t fold,
                                              std::size_t folds, double rate_hz) {
  std::vector<LagSubject> kept, out;
  for (std::size_t i = 0; i < subjects.size(); ++i) (i % folds == fold ? out : kept).push_back(subjects[i]);
  const PooledLags pooled = pool_lags(kept);
  const RunPair& any = subjects.front().run;
  const LinearStructure structure{any.states.values.rows(), any.inputs.values.rows(), true};
  std::vector<GlobalModel> globals;
  std::vector<std::vector<Trajectory>> joined(out.size());
  for (std::size_t c = 0; c < corrections; ++c) {
    const auto correction = static_cast<LagCorrection>(c);
    Recording recording;
    recording.states.resize(static_cast<std::size_t>(structure.states));
    recording.inputs.resize(static_cast<std::size_t>(structure.inputs));
    for (const LagSubject& s : kept)
      recording.runs.push_back(
          join_delayed(s.run, rate_hz, training_clock(correction, s.estimate, pooled, common_start_s(s.run))));
    globals.push_back(fit_global(recording, structure));
    for (std::size_t r = 0; r < out.size(); ++r)
      joined[r].push_back(
          join_delayed(out[r].run, rate_hz, held_out_clock(correction, pooled, common_start_s(out[r].run))));
  }
  std::vector<std::vector<RunScore>> scores(out.size());
  for (std::size_t r = 0; r < out.size(); ++r) {
    double first = -std::numeric_limits<double>::infinity(), last = -first;
    for (const Trajectory& run : joined[r]) {
      first = std::max(first, run.samples() > 0 ? run.time_s(0) : last);
      last = std::min(last, run.samples() > 0 ? run.time_s(run.samples() - 1) : first);
    }
    const double slack = 1e-9 * std::max(1.0, std::abs(last));
    for (std::size_t c = 0; c < corrections; ++c)
      scores[r].push_back(score(joined[r][c], globals[c], structure, first - slack, last + slack));
  }
  return scores;
}

LagScore summarise(LagCorrection correction, const std::vector<std::vector<RunScore>>& runs) {
  const auto c = static_cast<std::size_t>(correction);
  LagScore result;
  result.correction = correction;
  double log_density = 0.0, square_sum = 0.0, gain = 0.0, gain_squares = 0.0;
  for (const auto& run : runs) {
    log_density += run[c].log_density;
    square_sum += run[c].square_sum;
    gain += run[c].log_density - run[0].log_density;
    result.transitions += run[c].transitions;
  }
  if (result.transitions == 0) return result;
  const double N = static_cast<double>(result.transitions), R = static_cast<double>(runs.size());
  result.log_score = log_density / N;
  result.rmse = std::sqrt(square_sum / N);
  result.gain = gain / N;
  for (const auto& run : runs)
    gain_squares +=
        std::pow(run[c].log_density - run[0].log_density - result.gain * static_cast<double>(run[c].transitions), 2);
  if (runs.size() > 1) result.gain_standard_error = std::sqrt(R / (R - 1.0) * gain_squares) / N;
  return result;
}

}  // namespace

PooledLags pool_lags(const std::vector<LagSubject>& subjects) {
  std::vector<double> lag, lag_error, start, start_error, drift, drift_error;
  for (const LagSubject& s : subjects) {
    const RunLag& e = s.estimate;
    if (e.status == LagStatus::converged) {
      lag.push_back(e.lag_s);
      lag_error.push_back(e.lag_standard_error_s);
    }
    if (e.drift_status != LagStatus::converged || !std::isfinite(e.clock_drift_standard_error)) continue;
    // The lag in the middle of a run and the drift are nearly uncorrelated, so their errors are combined as
    // independent.
    const double before_s = e.applied_reference_s - common_start_s(s.run);
    start.push_back(e.drifting_lag_s - e.clock_drift * before_s);
    start_error.push_back(std::hypot(e.drifting_lag_standard_error_s, e.clock_drift_standard_error * before_s));
    drift.push_back(e.clock_drift);
    drift_error.push_back(e.clock_drift_standard_error);
  }
  const auto pool_of = [](const std::vector<double>& values, const std::vector<double>& errors) {
    const auto count = static_cast<Index>(values.size());
    return pool(Eigen::Map<const VectorXd>(values.data(), count), Eigen::Map<const VectorXd>(errors.data(), count));
  };
  return {pool_of(lag, lag_error), pool_of(start, start_error), pool_of(drift, drift_error)};
}

InputClock held_out_clock(LagCorrection correction, const PooledLags& pooled, double start_s) {
  if (correction == LagCorrection::none) return {};
  if (correction == LagCorrection::drift && pooled.drift.count > 0)
    return {pooled.start_lag.mean, pooled.drift.mean, start_s};
  return {pooled.lag.mean, 0.0, start_s};
}

InputClock training_clock(LagCorrection correction, const RunLag& estimate, const PooledLags& pooled, double start_s) {
  const InputClock common = held_out_clock(correction, pooled, start_s);
  if (correction == LagCorrection::per_run && estimate.status == LagStatus::converged)
    return {pooled.lag.shrunk(estimate.lag_s, estimate.lag_standard_error_s), 0.0, start_s};
  if (correction == LagCorrection::drift && estimate.drift_status == LagStatus::converged && pooled.drift.count > 0) {
    const double middle_s = estimate.applied_reference_s;
    const double drift = pooled.drift.shrunk(estimate.clock_drift, estimate.clock_drift_standard_error);
    return {estimate.drifting_lag_s, drift, middle_s};
  }
  return common;
}

Trajectory join_delayed(const RunPair& run, double rate_hz, const InputClock& clock) {
  Trajectory joined;
  joined.run = run.run;
  joined.role = Role::train;
  joined.lag_s = clock.lag_s;
  joined.time_s =
      joint_times(run.states.time_s, run.inputs.time_s, {rate_hz, clock.lag_s, clock.drift, clock.reference_s});
  if (joined.time_s.size() == 0) {
    joined.state.resize(run.states.values.rows(), 0);
    joined.input.resize(run.inputs.values.rows(), 0);
    return joined;
  }
  joined.state = interpolate(run.states, joined.time_s);
  blank_gaps(run.states.time_s, joined.time_s, joined.state);
  joined.input = hold_mid_transition(run.inputs, joined.time_s, clock);
  const double longest = gap_periods * median_period_s(joined.time_s);
  for (Index k = 1; k < joined.samples(); ++k)
    if (joined.time_s(k) - joined.time_s(k - 1) > longest)
      joined.state.col(k).setConstant(std::numeric_limits<double>::quiet_NaN());
  return joined;
}

std::vector<LagScore> cross_validate_lags(const std::vector<LagSubject>& subjects, double rate_hz) {
  const std::size_t folds = std::min(subjects.size(), most_folds);
  std::vector<std::vector<std::vector<RunScore>>> by_fold(folds);
  WorkCounter counter("folds of the lag's cross-validation", folds);
  tbb::parallel_for(std::size_t{0}, folds, [&](std::size_t f) {
    by_fold[f] = score_fold(subjects, f, folds, rate_hz);
    counter.add();
  });
  std::vector<std::vector<RunScore>> runs;
  for (auto& fold : by_fold) runs.insert(runs.end(), fold.begin(), fold.end());
  std::vector<LagScore> scores;
  for (std::size_t c = 0; c < corrections; ++c) scores.push_back(summarise(static_cast<LagCorrection>(c), runs));
  return scores;
}

}  // namespace modebank
