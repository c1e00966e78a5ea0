#include "ident/lag/choice.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "ident/lag/cross_validation.hpp"
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

/// The pooled lag if its gain is above the gain's standard error.
LagCorrection decide(const std::vector<LagScore>& scores) {
  const LagScore& pooled = scores.back();
  return pooled.gain > 0.0 && pooled.gain > pooled.gain_standard_error ? LagCorrection::pooled : LagCorrection::none;
}

}  // namespace

RunLag estimate_run(const RunPair& run, double range_s) {
  const LagFit fit = estimate_lag(run.states, run.inputs, {range_s});
  RunLag result;
  result.run = run.run;
  result.status = fit.status;
  result.lag_s = fit.lag_s;
  result.lag_standard_error_s = fit.lag_standard_error_s;
  result.time_constant_s = fit.time_constant_s;
  result.r_squared = fit.r_squared;
  return result;
}

LagReport choose_lag(const std::vector<RunPair>& runs, const LagChoiceOptions& options) {
  const std::vector<LagSubject> subjects = subjects_of(runs, options.range_s);
  if (subjects.empty()) throw DataError("data.lag_s = auto: there is no training run to estimate the lag on");
  LagReport report;
  report.scores = cross_validate_lags(subjects, options.rate_hz);
  report.correction = decide(report.scores);
  // If there is a single training run, its halves serve only for the scores; the estimate below uses the whole run.
  const bool split =
      std::count_if(runs.begin(), runs.end(), [](const RunPair& r) { return r.role == Role::train; }) == 1;
  std::vector<LagSubject> whole = subjects;
  if (split) {
    const auto only = std::find_if(runs.begin(), runs.end(), [](const RunPair& r) { return r.role == Role::train; });
    whole = {{*only, estimate_run(*only, options.range_s)}};
  }
  report.lag = pool_lags(whole);
  std::size_t subject = 0;
  for (const RunPair& run : runs) {
    RunLag& entry = report.runs.emplace_back();
    if (run.role == Role::train) entry = whole[subject++].estimate;
    entry.run = run.run;
    entry.applied_lag_s = corrected_lag_s(report.correction, report.lag);
  }
  return report;
}

}  // namespace modebank
