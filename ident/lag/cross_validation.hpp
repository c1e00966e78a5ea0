#pragma once

#include <vector>

#include "ident/lag/choice.hpp"

namespace modebank {

/// A run and what was estimated on it.
struct LagSubject {
  RunPair run;
  RunLag estimate;
};

struct PooledLags {
  PooledEstimate lag, start_lag, drift;
};

/// Random-effects means of the usable estimates.
PooledLags pool_lags(const std::vector<LagSubject>& subjects);

/// What a correction does to a run that none of the pooled estimates came from, and to one that they came from.
/// `start_s`: when both streams of the run have begun; drifts count from there, as no one knows a run's middle before
/// it is over.
InputClock held_out_clock(LagCorrection correction, const PooledLags& pooled, double start_s);
InputClock training_clock(LagCorrection correction, const RunLag& estimate, const PooledLags& pooled, double start_s);

/// States interpolated and inputs delayed by `clock`, as import joins runs under data.lag_s = auto; transitions across
/// gaps or missing values hold NaN.
Trajectory join_delayed(const RunPair& run, double rate_hz, const InputClock& clock);

/// One score per correction (ident/lag/choice.hpp).
std::vector<LagScore> cross_validate_lags(const std::vector<LagSubject>& subjects, double rate_hz);

}  // namespace modebank
