#pragma once

#include <Eigen/Core>

namespace modebank {

/// One quantity that was estimated in several runs. Its true values may differ between the runs.
struct PooledEstimate {
  double mean = 0.0;
  double standard_error = 0.0;  ///< standard error of the mean; NaN without estimates
  double between_sd = 0.0;      ///< standard deviation of the true values between runs
  Eigen::Index count = 0;       ///< number of pooled estimates
};

/// Random-effects mean by the moment estimator of DerSimonian & Laird (1986), with weights 1 / (error^2 + between^2).
PooledEstimate pool(const Eigen::VectorXd& estimates, const Eigen::VectorXd& errors);

}  // namespace modebank
