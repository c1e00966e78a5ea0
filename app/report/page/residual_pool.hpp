#pragma once

#include <vector>

#include "ident/model/residual_tests.hpp"

namespace modebank {

/// Pools the autocorrelations of several runs.
/// - At each lag the result is the mean over the runs that have this lag, weighted by their samples.
/// - The band is that of white residuals for the samples of all runs.
/// - Cross-correlations and Ljung-Box values stay empty.
/// - Runs with an undefined autocorrelation are ignored. If all are ignored, the result has no lags.
ResidualTests pool_autocorrelations(const std::vector<ResidualTests>& runs);

}  // namespace modebank
