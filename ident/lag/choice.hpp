#pragma once

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

struct LagChoiceOptions {
  double range_s = 2.5;
  double rate_hz = 0.0;  ///< rate at which the runs will be joined
};

/// Estimates the lag of one run without applying it.
RunLag estimate_run(const RunPair& run, double range_s);

/// Estimates the lag of every training run. Decides by cross-validation over the training runs whether the pooled lag
/// is applied to all runs (at most ten folds; a single run is split in halves). The score is the log score of the
/// global model's one-step predictions (with intercept, Gaussian) on the transitions that both corrections share. The
/// pooled lag is applied if its gain is above one standard error. A left-out run is shifted by the pooled lag of the
/// other runs. Parallel over runs, deterministic.
LagReport choose_lag(const std::vector<RunPair>& runs, const LagChoiceOptions& options);

}  // namespace modebank
