#pragma once

#include <Eigen/Core>
#include <functional>

#include "ident/fit/options.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

/// Gaussian prior on theta, independent per parameter.
struct ParameterPrior {
  Eigen::VectorXd mean;  ///< p
  Eigen::VectorXd sd;    ///< p
};

/// Default prior standard deviations: 3 x the robust standard deviation over windows. The windows are full-rank robust
/// fits without prior (`parameters` p x M, one per column). Windows that are not finite are ignored.
///
/// The robust standard deviation is 1.4826 times the median absolute deviation per parameter. Windows near the rank
/// tolerance have extreme estimates, which would dominate a sample standard deviation. If the robust value is zero
/// (more than half of the windows agree exactly), the sample standard deviation is used. If this is also zero, or
/// without full-rank windows, the value is global standard error x sqrt(N / length). This is the standard deviation
/// that noise alone gives windows of `length` transitions. If this standard deviation is zero or undefined, the value
/// is 1.
Eigen::VectorXd default_prior_sd(const Eigen::MatrixXd& parameters, const GlobalModel& global, Index length);

/// Prior standard deviations from the options, one per parameter or one for all parameters. Without this option,
/// default_prior_sd of the result of `unregularised()`.
Eigen::VectorXd make_prior_sd(const FitOptions& options, const GlobalModel& global,
                              const std::function<Eigen::MatrixXd()>& unregularised);

}  // namespace modebank
