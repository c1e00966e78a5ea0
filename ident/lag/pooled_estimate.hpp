#pragma once

#include <Eigen/Core>

namespace modebank {

/// One quantity estimated in several runs that may truly differ.
struct PooledEstimate {
  double mean = 0.0;
  double standard_error = 0.0;  ///< of the mean; NaN without any estimate
  double between_sd = 0.0;      ///< standard deviation of the true values between runs
  Eigen::Index count = 0;       ///< estimates pooled

  /// Best guess of one run's true value: its estimate, drawn towards the mean the more its error exceeds the spread
  /// between runs (empirical Bayes).
  double shrunk(double estimate, double error) const;
};

/// Random-effects mean by the moment estimator of DerSimonian & Laird (1986), weights 1 / (error^2 + between^2).
PooledEstimate pool(const Eigen::VectorXd& estimates, const Eigen::VectorXd& errors);

}  // namespace modebank
