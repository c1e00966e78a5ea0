#include "ident/lag/choice.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "ident/lag/cross_validation.hpp"
#include "ident/lag/track.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The first or the second half (in time) of a run.
RunPair half(const RunPair& run, bool second) {
  const VectorXd& t = run.states.time_s;
  const double middle = 0.5 * (t(0) + t(t.size() - 1));
  const auto part = [&](const Stream& stream) {
    const double* const begin = stream.time_s.data();
    const Index first = std::lower_bound(begin, begin + stream.time_s.size(), middle) - begin;
    const Index count = second ? stream.time_s.size() - first : first;
    return Stream{stream.time_s.segment(second ? first : 0, count),
                  stream.values.middleCols(second ? first : 0, count)};
  };
  return {run.run, run.role, part(run.states), part(run.inputs)};
}

/// The runs that are left out in turn, with their estimates.
std::vector<LagSubject> subjects_of(const std::vector<RunPair>& runs, double range_s) {
  std::vector<LagSubject> subjects;
  for (const RunPair& run : runs)
    if (run.role == Role::train) subjects.push_back({run, {}});
  if (subjects.size() == 1) {
    const RunPair whole = subjects.front().run;
    subjects = {{half(whole, false), {}}, {half(whole, true), {}}};
  }
  tbb::parallel_for(std::size_t{0}, subjects.size(),
                    [&](std::size_t i) { subjects[i].estimate = estimate_run(subjects[i].run, range_s); });
  return subjects;
}

void apply(RunLag& run, const InputClock& clock) {
  run.applied_lag_s = clock.lag_s;
  run.applied_clock_drift = clock.drift;
  run.applied_reference_s = clock.reference_s;
}

/// The simplest correction (in the order of LagCorrection) that meets two conditions. Its gain is above its standard
/// error. Its score is within one standard error of the best (Breiman et al. 1984, sec. 3.4.3).
LagCorrection decide(const std::vector<LagScore>& scores) {
  const auto gains = [](const LagScore& score) { return score.gain > 0.0 && score.gain > score.gain_standard_error; };
  const LagScore* best = nullptr;
  for (const LagScore& score : scores)
    if (gains(score) && (!best || score.gain > best->gain)) best = &score;
  for (const LagScore& score : scores)
    if (best && gains(score) && score.gain >= best->gain - best->gain_standard_error) return score.correction;
  return LagCorrection::none;
}

}  // namespace

RunLag estimate_run(const RunPair& run, double range_s) {
  const LagEstimate estimate = estimate_lag(run.states, run.inputs, {range_s});
  const LagTrack track = track_lag(run.states, run.inputs, {.range_s = range_s});
  RunLag result;
  result.run = run.run;
  result.status = estimate.constant.status;
  result.lag_s = estimate.constant.clock.lag_s;
  result.lag_standard_error_s = estimate.constant.lag_standard_error_s;
  result.time_constant_s = estimate.constant.time_constant_s;
  result.r_squared = estimate.constant.r_squared;
  result.drift_status = estimate.drifting.status;
  result.drifting_lag_s = estimate.drifting.clock.lag_s;
  result.drifting_lag_standard_error_s = estimate.drifting.lag_standard_error_s;
  result.clock_drift = estimate.drifting.clock.drift;
  result.clock_drift_standard_error = estimate.drifting.drift_standard_error;
  result.match_s = track.median_s();
  result.match_least_s = track.least_s();
  result.match_largest_s = track.largest_s();
  result.match_windows = track.windows();
  result.applied_reference_s = estimate.drifting.clock.reference_s;
  return result;
}

LagReport choose_lag(const std::vector<RunPair>& runs, const LagChoiceOptions& options) {
  const std::vector<LagSubject> subjects = subjects_of(runs, options.range_s);
  if (subjects.empty()) throw DataError("data.lag_s = auto: there is no training run to estimate the lag on");
  LagReport report;
  report.scores = cross_validate_lags(subjects, options.rate_hz);
  report.correction = decide(report.scores);
  // If there is a single training run, its halves serve only for the scores; the estimates below use the whole run.
  const bool split =
      std::count_if(runs.begin(), runs.end(), [](const RunPair& r) { return r.role == Role::train; }) == 1;
  std::vector<LagSubject> whole = subjects;
  if (split) {
    const auto only = std::find_if(runs.begin(), runs.end(), [](const RunPair& r) { return r.role == Role::train; });
    whole = {{*only, estimate_run(*only, options.range_s)}};
  }
  const PooledLags pooled = pool_lags(whole);
  report.lag = pooled.lag;
  report.start_lag = pooled.start_lag;
  report.drift = pooled.drift;
  std::size_t subject = 0;
  for (const RunPair& run : runs) {
    RunLag& entry = report.runs.emplace_back();
    if (run.role == Role::train) entry = whole[subject++].estimate;
    entry.run = run.run;
    apply(entry, run.role == Role::train ? training_clock(report.correction, entry, pooled, common_start_s(run))
                                         : held_out_clock(report.correction, pooled, common_start_s(run)));
  }
  return report;
}

}  // namespace modebank
