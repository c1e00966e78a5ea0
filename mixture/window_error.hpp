#pragma once

#include <Eigen/Core>

#include "ident/model/local_model.hpp"

namespace modebank {

/// What the window's data alone say of theta: the posterior without the prior (mean the global model, standard
/// deviations prior_sd), as estimate and covariance. In units of the prior a posterior variance c along an eigenvector
/// is a measurement of variance c / (1 - c), and the posterior's offset from the prior is 1 - c of the measured one.
void take_off_prior(const WindowFits& fits, Eigen::VectorXd& theta, Eigen::MatrixXd& covariance);

/// Variance of the logarithm of a noise variance that L transitions leave over after `rank` / n parameters.
double log_variance_error(const WindowFits& fits, Eigen::Index window);

}  // namespace modebank
