#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "ident/data/streams.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/lag/report.hpp"

namespace modebank {

/// The two streams of one run. Times are strictly increasing; values may be NaN.
struct RunPair {
  std::string run;
  Role role = Role::train;
  Stream states, inputs;
};

/// The first time that is covered by both streams.
inline double common_start_s(const RunPair& run) { return std::max(run.states.time_s(0), run.inputs.time_s(0)); }

struct LagChoiceOptions {
  double range_s = 2.5;
  double rate_hz = 0.0;  ///< rate at which the runs will be joined
};

/// Estimates the lags of one run without applying them.
RunLag estimate_run(const RunPair& run, double range_s);

/// Estimates lag and drift of every training run. Chooses a correction by cross-validation over the training runs (at
/// most ten folds; a single run is split in halves). The score is the log score of the global model's one-step
/// predictions (with intercept, Gaussian) on the transitions that all corrections share. The choice is the simplest
/// correction that meets two conditions. Its gain over `none` is above one standard error. Its score is within one
/// standard error of the best score. A left-out run is shifted like a held-out run, by the pooled values of the other
/// runs. Training runs use their own estimates, shrunk towards the pooled values by their errors. Runs without a usable
/// estimate use the pooled values. Parallel over runs, deterministic.
LagReport choose_lag(const std::vector<RunPair>& runs, const LagChoiceOptions& options);

}  // namespace modebank
