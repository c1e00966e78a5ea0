#pragma once

#include <vector>

#include "ident/model/residual_tests.hpp"

namespace modebank {

/// Autocorrelations of several runs as one: the mean by samples at every lag, over the runs that have it, and the band
/// of white residuals for as many samples together. Cross-correlations and Ljung-Box values are left empty. Runs whose
/// autocorrelation is not defined are left out; without any left the result has no lags.
ResidualTests pool_autocorrelations(const std::vector<ResidualTests>& runs);

}  // namespace modebank
