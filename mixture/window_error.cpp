#include "mixture/window_error.hpp"

#include <algorithm>

#include "ident/base/linalg.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Data with less than this share in what is known of a direction are treated as if they had it, so that a direction of
/// which a window says nothing gets an error of 20 prior variances rather than an infinite one.
constexpr double least_information = 0.05;

}  // namespace

void take_off_prior(const WindowFits& fits, Eigen::VectorXd& theta, Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd &sd = fits.prior_sd, &mean = fits.global.theta;
  const Eigen::VectorXd inverse = sd.cwiseInverse();
  const auto [values, vectors] = symmetric_eigen(inverse.asDiagonal() * covariance * inverse.asDiagonal());
  const Eigen::ArrayXd known = (1.0 - values.array()).max(least_information);
  const Eigen::VectorXd measured =
      vectors * ((vectors.transpose() * (theta - mean).cwiseQuotient(sd)).array() / known).matrix();
  theta = mean + measured.cwiseProduct(sd);
  const Eigen::VectorXd variance = values.array().max(0.0) / known;
  covariance = sd.asDiagonal() * vectors * variance.asDiagonal() * vectors.transpose() * sd.asDiagonal();
  covariance = (0.5 * (covariance + covariance.transpose())).eval();
}

double log_variance_error(const WindowFits& fits, Index window) {
  const double transitions = static_cast<double>(fits.transitions.size() > 0 ? fits.transitions(window) : fits.length);
  const double unknowns = static_cast<double>(fits.rank(window)) / static_cast<double>(fits.structure.states);
  return 2.0 / std::max(transitions - unknowns, 1.0);
}

}  // namespace modebank
