#pragma once

#include <Eigen/Core>

#include "ident/lag/objective.hpp"

namespace modebank {

/// Long-run covariance of the scores (q x N): their autocovariances, summed over lags with Bartlett weights (Newey &
/// West 1987). Bandwidth by Andrews (1991), eq. 6.2 and 6.4, for first-order autoregressions.
Eigen::MatrixXd long_run_sum(const Eigen::MatrixXd& scores);

/// Variances of lag, drift and time constant at the optimum. NaN for a parameter that the data do not determine. A
/// parameter that is held or at its bound has variance 0.
struct LagVariances {
  double lag_s2 = 0.0, drift = 0.0, time_constant_s2 = 0.0;
};
LagVariances lag_variances(const LagObjective& objective, const LagPoint& point, bool with_drift);

}  // namespace modebank
