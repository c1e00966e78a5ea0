#pragma once

#include <Eigen/Core>

#include "ident/model/local_model.hpp"

namespace modebank {

/// Removes the prior (mean: the global model, standard deviations: prior_sd) from a window's theta and covariance. The
/// result is the estimate from the window's data alone. In directions where the data have less than 5 % of the
/// information, 5 % is assumed. The variance is then 20 prior variances instead of infinite.
///
/// In units of the prior, the data's information D gives the posterior covariance C = (D + I)^-1, so D = C^-1 - I. The
/// posterior offset from the prior's mean is (W + I)^-1 W times the data's offset. W is the information of the data in
/// the fit itself: for state i it is weighed_information(i) times its block of D. W and D differ because robust
/// estimates are weighted by sigma, while their covariance uses the residuals' variance.
void take_off_prior(const WindowFits& fits, Eigen::Index window, Eigen::VectorXd& theta, Eigen::MatrixXd& covariance);

/// Whether take_off_prior can be applied. A sandwich covariance is not a posterior, so the result is false for it.
bool prior_comes_off(const WindowFits& fits, Eigen::Index window);

/// Variance of the logarithm of a noise variance, estimated from L transitions after a fit of `rank` / n parameters.
double log_variance_error(const WindowFits& fits, Eigen::Index window);

}  // namespace modebank
