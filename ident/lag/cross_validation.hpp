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

/// The clock of a correction, for a run whose estimates are not in the pooled values and for a run whose estimates are.
/// `start_s` is the first time that both streams of the run cover. Drifts count from this time, because the middle of a
/// run is unknown before its end.
InputClock held_out_clock(LagCorrection correction, const PooledLags& pooled, double start_s);
InputClock training_clock(LagCorrection correction, const RunLag& estimate, const PooledLags& pooled, double start_s);

/// Joins the streams of a run in the same way as an import with data.lag_s = auto: states interpolated, inputs delayed
/// by `clock`. Transitions across gaps or missing values are NaN.
Trajectory join_delayed(const RunPair& run, double rate_hz, const InputClock& clock);

/// Scores of all corrections, one element per correction (ident/lag/choice.hpp).
std::vector<LagScore> cross_validate_lags(const std::vector<LagSubject>& subjects, double rate_hz);

}  // namespace modebank
