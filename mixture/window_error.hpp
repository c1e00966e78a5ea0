#pragma once

#include <Eigen/Core>

#include "ident/model/local_model.hpp"

namespace modebank {

/// Removes the prior (mean: the global model, standard deviations prior_sd) from a window's theta and covariance. The
/// result is the estimate of the window's data alone. In directions where data have less than 5 % of the information, 5
/// % is used. The variance is then 20 prior variances instead of infinite.
///
/// In units of the prior, data information D gives the posterior covariance C = (D + I)^-1, so D = C^-1 - I. The
/// posterior offset from the prior's mean is (W + I)^-1 W times the data's offset. W is the information that the fit
/// weighed against the prior: for state i weighed_information(i) times its block of D. The two differ because robust
/// estimates are weighed by sigma, and their covariance uses the residuals' variance.
void take_off_prior(const WindowFits& fits, Eigen::Index window, Eigen::VectorXd& theta, Eigen::MatrixXd& covariance);

/// Whether take_off_prior applies. It does not apply to a sandwich covariance, which is not a posterior.
bool prior_comes_off(const WindowFits& fits, Eigen::Index window);

/// Variance of the logarithm of a noise variance that is estimated from L transitions after fitting `rank` / n
/// parameters.
double log_variance_error(const WindowFits& fits, Eigen::Index window);

}  // namespace modebank
