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

/// Default prior standard deviations: 3 x the spread of the robust fits of full-rank windows made without prior
/// (`parameters` p x M, one per column; those that are not finite do not count). The spread is 1.4826 times the median
/// absolute deviation per parameter, because windows close to the rank tolerance have estimates far outside any model's
/// range, and one of them would decide a sample standard deviation. Where that is zero (more than half of the windows
/// agree exactly) it is the sample standard deviation. Where that is zero too, or without any full-rank window: the
/// spread that windows of `length` transitions would show by noise alone, global standard error x sqrt(N / length); and
/// 1 where even that is zero or undefined.
Eigen::VectorXd default_prior_sd(const Eigen::MatrixXd& parameters, const GlobalModel& global, Index length);

/// The standard deviations that the options give, one per parameter or one for all; without them default_prior_sd of
/// `unregularised()`.
Eigen::VectorXd make_prior_sd(const FitOptions& options, const GlobalModel& global,
                              const std::function<Eigen::MatrixXd()>& unregularised);

}  // namespace modebank
