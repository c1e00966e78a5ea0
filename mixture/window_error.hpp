#pragma once

#include <Eigen/Core>

#include "ident/model/local_model.hpp"

namespace modebank {

/// What a window's data alone say of theta: the posterior without the prior (mean the global model, standard deviations
/// prior_sd), as estimate and covariance. A direction of which data have less than 5 % of the say is treated as if they
/// had it, so that it gets an error of 20 prior variances rather than an infinite one.
///
/// In units of the prior, information D of the data makes a posterior covariance C = (D + I)^-1, so D = C^-1 - I; the
/// offset from the prior's mean was (W + I)^-1 W times what data say, with W the information that the fit weighed
/// against the prior: that of state i is weighed_information(i) times its block of D, because robust estimates are
/// weighed by sigma and stated by the variance of their residuals.
void take_off_prior(const WindowFits& fits, Eigen::Index window, Eigen::VectorXd& theta, Eigen::MatrixXd& covariance);

/// Whether take_off_prior can: not of a sandwich covariance, which is no posterior.
bool prior_comes_off(const WindowFits& fits, Eigen::Index window);

/// Variance of the logarithm of a noise variance that L transitions leave over after `rank` / n parameters.
double log_variance_error(const WindowFits& fits, Eigen::Index window);

}  // namespace modebank
