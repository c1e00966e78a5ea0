#include "filter/noise_parameters.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "filter/noise_floor.hpp"

namespace modebank {
Index NoiseParametrisation::size() const { return triangle() + std::count(held_.begin(), held_.end(), false); }

NoiseCovariances NoiseParametrisation::decode(const double* coordinates) const {
  const Index n = scale_.size();
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < i; ++j) L(i, j) = *coordinates++;
    L(i, i) = std::exp(*coordinates++);
  }
  const Eigen::VectorXd sd = scale_.cwiseSqrt();
  NoiseCovariances noise;
  noise.Q = sd.asDiagonal() * (L * L.transpose() + rounding_share * Eigen::MatrixXd::Identity(n, n)) * sd.asDiagonal();
  noise.R = bound_.asDiagonal();
  for (Index i = 0; i < n; ++i)
    if (!held_[i]) noise.R(i, i) += scale_(i) * std::exp(*coordinates++);
  return noise;
}

Eigen::VectorXd NoiseParametrisation::coordinates(double q_share, double r_share) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(size());
  for (Index i = 0; i < scale_.size(); ++i) result(i * (i + 3) / 2) = 0.5 * std::log(q_share);
  result.tail(size() - triangle()).setConstant(std::log(r_share));
  return result;
}

Index NoiseParametrisation::position_of(Index output) const {
  assert(!held_[output]);
  return triangle() + std::count(held_.begin(), held_.begin() + output, false);
}

NoiseParametrisation NoiseParametrisation::hold(Index output) const {
  NoiseParametrisation result = *this;
  result.held_[output] = true;
  return result;
}

Eigen::VectorXd NoiseParametrisation::without(const Eigen::VectorXd& coordinates, Index output) const {
  const Index gap = position_of(output);
  Eigen::VectorXd result(coordinates.size() - 1);
  result << coordinates.head(gap), coordinates.tail(coordinates.size() - gap - 1);
  return result;
}

}  // namespace modebank
