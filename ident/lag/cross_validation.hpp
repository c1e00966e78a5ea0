#pragma once

#include <vector>

#include "ident/lag/choice.hpp"

namespace modebank {

/// A run and its estimate.
struct LagSubject {
  RunPair run;
  RunLag estimate;
};

/// Random-effects mean of the usable estimates.
PooledEstimate pool_lags(const std::vector<LagSubject>& subjects);

/// The lag that a correction applies.
double corrected_lag_s(LagCorrection correction, const PooledEstimate& pooled);

/// Joins the streams of a run in the same way as an import with data.lag_s = auto: states interpolated, inputs delayed
/// by `lag_s`. Transitions across gaps or missing values are NaN.
Trajectory join_delayed(const RunPair& run, double rate_hz, double lag_s);

/// Scores of both corrections, `none` first (ident/lag/choice.hpp).
std::vector<LagScore> cross_validate_lags(const std::vector<LagSubject>& subjects, double rate_hz);

}  // namespace modebank
