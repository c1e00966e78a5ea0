#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "ident/data/streams.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/lag/report.hpp"

namespace modebank {

/// The two streams of one run, times strictly increasing; values may be NaN.
struct RunPair {
  std::string run;
  Role role = Role::train;
  Stream states, inputs;
};

/// Where both streams have begun.
inline double common_start_s(const RunPair& run) { return std::max(run.states.time_s(0), run.inputs.time_s(0)); }

struct LagChoiceOptions {
  double range_s = 2.5;
  double rate_hz = 0.0;  ///< as the runs will be joined
};

/// Estimates of one run, nothing applied.
RunLag estimate_run(const RunPair& run, double range_s);

/// Estimates every training run's lag and drift and decides by cross-validation over the training runs (at most ten
/// folds; a single run is split in halves) what to apply, by the log score of the global model's one-step predictions
/// (with intercept, Gaussian, on the transitions that all corrections share): the simplest correction that gains more
/// than one standard error over none and is within one of the best. A run left out is shifted as a test run would be:
/// by the pooled values of the others, never by its own. Training runs take their own estimates, shrunk towards the
/// pooled ones by their errors; runs without a usable estimate take the pooled. In parallel over runs, deterministic.
LagReport choose_lag(const std::vector<RunPair>& runs, const LagChoiceOptions& options);

}  // namespace modebank
