#pragma once

#include <vector>

#include "ident/model/residual_tests.hpp"

namespace modebank {

/// Pools the autocorrelations of several runs.
/// - At every lag it is the mean over the runs that have this lag, weighted by samples.
/// - The band is that of white residuals for all these samples.
/// - Cross-correlations and Ljung-Box values stay empty.
/// - Runs without a defined autocorrelation are left out. If none remains, the result has no lags.
ResidualTests pool_autocorrelations(const std::vector<ResidualTests>& runs);

}  // namespace modebank
