#include "mixture/window_error.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/linalg.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr double least_information = 0.05;

/// Information of the data along orthonormal directions, in units of the prior's information.
struct DataInformation {
  Eigen::MatrixXd directions;
  Eigen::ArrayXd along;

  /// Share of the data in the posterior information of each direction; at least least_information.
  Eigen::ArrayXd share(double weighed) const { return (1.0 - 1.0 / (1.0 + weighed * along)).max(least_information); }
};

DataInformation information_of(const Eigen::MatrixXd& posterior) {
  constexpr double least_variance = 1e-300;
  const auto [values, vectors] = symmetric_eigen(posterior);
  const Eigen::ArrayXd variance = values.array().max(least_variance);
  return {vectors, ((1.0 - variance) / variance).max(0.0)};
}

/// Information about `size` parameters from `first` on: the parameters of one state.
DataInformation block_of(const DataInformation& all, Index first, Index size) {
  const Eigen::MatrixXd rows = all.directions.middleRows(first, size);
  const auto [values, vectors] = symmetric_eigen(rows * all.along.matrix().asDiagonal() * rows.transpose());
  return {vectors, values.array().max(0.0)};
}

/// Offset of the data's own estimate from the prior's mean, with the prior's pull towards the mean removed.
Eigen::VectorXd unpulled(const DataInformation& data, double weighed, const Eigen::VectorXd& offset) {
  return data.directions * ((data.directions.transpose() * offset).array() / data.share(weighed)).matrix();
}

double weighed_information(const WindowFits& fits, Index state, Index window) {
  return fits.weighed_information.cols() > 0 ? fits.weighed_information(state, window) : 1.0;
}

}  // namespace

bool prior_comes_off(const WindowFits& fits, Index window) {
  return std::isfinite(weighed_information(fits, 0, window));
}

void take_off_prior(const WindowFits& fits, Index window, Eigen::VectorXd& theta, Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd &sd = fits.prior_sd, &mean = fits.global.theta;
  const Eigen::VectorXd inverse = sd.cwiseInverse();
  const DataInformation data = information_of(inverse.asDiagonal() * covariance * inverse.asDiagonal());
  // All states of a motion model have the same parameters.
  const bool shared = !fits.model_parameters.empty() || fits.structure.states == 1;
  const Index blocks = shared ? 1 : fits.structure.states, size = theta.size() / blocks;
  Eigen::VectorXd offset = (theta - mean).cwiseQuotient(sd);
  for (Index i = 0; i < blocks; ++i) {
    const double weighed = weighed_information(fits, i, window);
    const Eigen::VectorXd part = offset.segment(i * size, size);
    offset.segment(i * size, size) = unpulled(shared ? data : block_of(data, i * size, size), weighed, part);
  }
  theta = mean + offset.cwiseProduct(sd);
  // If the posterior variance is c (in units of the prior variance), the data alone give the variance c / (1 - c).
  const Eigen::ArrayXd variance = 1.0 / ((1.0 + data.along) * data.share(1.0));
  const Eigen::MatrixXd root = sd.asDiagonal() * data.directions;
  covariance = root * variance.matrix().asDiagonal() * root.transpose();
  covariance = (0.5 * (covariance + covariance.transpose())).eval();
}

double log_variance_error(const WindowFits& fits, Index window) {
  const double transitions = static_cast<double>(fits.transitions.size() > 0 ? fits.transitions(window) : fits.length);
  const double unknowns = static_cast<double>(fits.rank(window)) / static_cast<double>(fits.structure.states);
  return 2.0 / std::max(transitions - unknowns, 1.0);
}

}  // namespace modebank
