#pragma once

#include <vector>

#include "ident/lag/choice.hpp"

namespace modebank {

/// A run and its estimates.
struct LagSubject {
  RunPair run;
  RunLag estimate;
};

struct PooledLags {
  PooledEstimate lag, start_lag, drift;
};

/// Random-effects means of the usable estimates.
PooledLags pool_lags(const std::vector<LagSubject>& subjects);

/// The clock of a correction for a run that did not contribute to the pooled estimates, and for a run that did.
/// `start_s`: first time that both streams of the run cover. Drifts count from this time, because the middle of a run
/// is unknown before its end.
InputClock held_out_clock(LagCorrection correction, const PooledLags& pooled, double start_s);
InputClock training_clock(LagCorrection correction, const RunLag& estimate, const PooledLags& pooled, double start_s);

/// Joins a run in the same way as import with data.lag_s = auto: states interpolated, inputs delayed by `clock`.
/// Transitions across gaps or missing values are NaN.
Trajectory join_delayed(const RunPair& run, double rate_hz, const InputClock& clock);

/// Scores of all corrections, one element each (ident/lag/choice.hpp).
std::vector<LagScore> cross_validate_lags(const std::vector<LagSubject>& subjects, double rate_hz);

}  // namespace modebank
