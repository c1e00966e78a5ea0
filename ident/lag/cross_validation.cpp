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

/// Scores of all runs of one fold for both corrections, ordered by run, then by correction.
std::vector<std::vector<RunScore>> score_fold(const std::vector<LagSubject>& subjects, std::size_t fold,
                                              std::size_t folds, double rate_hz) {
  std::vector<LagSubject> kept, out;
  for (std::size_t i = 0; i < subjects.size(); ++i) (i % folds == fold ? out : kept).push_back(subjects[i]);
  const PooledEstimate pooled = pool_lags(kept);
  const RunPair& any = subjects.front().run;
  const LinearStructure structure{any.states.values.rows(), any.inputs.values.rows(), true};
  std::vector<GlobalModel> globals;
  std::vector<std::vector<Trajectory>> joined(out.size());
  for (std::size_t c = 0; c < corrections; ++c) {
    const double lag_s = corrected_lag_s(static_cast<LagCorrection>(c), pooled);
    Recording recording;
    recording.states.resize(static_cast<std::size_t>(structure.states));
    recording.inputs.resize(static_cast<std::size_t>(structure.inputs));
    for (const LagSubject& s : kept) recording.runs.push_back(join_delayed(s.run, rate_hz, lag_s));
    globals.push_back(fit_global(recording, structure));
    for (std::size_t r = 0; r < out.size(); ++r) joined[r].push_back(join_delayed(out[r].run, rate_hz, lag_s));
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

PooledEstimate pool_lags(const std::vector<LagSubject>& subjects) {
  std::vector<double> lag_s, error_s;
  for (const LagSubject& s : subjects) {
    if (s.estimate.status != LagStatus::converged) continue;
    lag_s.push_back(s.estimate.lag_s);
    error_s.push_back(s.estimate.lag_standard_error_s);
  }
  const auto count = static_cast<Index>(lag_s.size());
  return pool(Eigen::Map<const VectorXd>(lag_s.data(), count), Eigen::Map<const VectorXd>(error_s.data(), count));
}

double corrected_lag_s(LagCorrection correction, const PooledEstimate& pooled) {
  return correction == LagCorrection::none ? 0.0 : pooled.mean;
}

Trajectory join_delayed(const RunPair& run, double rate_hz, double lag_s) {
  Trajectory joined;
  joined.run = run.run;
  joined.role = Role::train;
  joined.lag_s = lag_s;
  joined.time_s = joint_times(run.states.time_s, run.inputs.time_s, {rate_hz, lag_s});
  if (joined.time_s.size() == 0) {
    joined.state.resize(run.states.values.rows(), 0);
    joined.input.resize(run.inputs.values.rows(), 0);
    return joined;
  }
  joined.state = interpolate(run.states, joined.time_s);
  blank_gaps(run.states.time_s, joined.time_s, joined.state);
  joined.input = hold_mid_transition(run.inputs, joined.time_s, lag_s);
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
