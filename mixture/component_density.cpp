#include "mixture/component_density.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "mixture/block_arithmetic.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Squared distances beyond this (points so far out that squares overflow) count as this, so no density is ever NaN.
constexpr double largest_distance = 2e300;
/// Relative densities below exp(-600) count as that: no denormal numbers, which are slow, and nothing lost at double
/// precision.
constexpr double smallest_log_ratio = -600.0;
/// Stands for the logarithm of a zero weight.
constexpr double log_zero = -1e300;

Eigen::MatrixXd inverse_cholesky(const Eigen::MatrixXd& covariance, bool diagonal, Index component) {
  const Index features = covariance.rows();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(features, features);
  bool positive = covariance.diagonal().minCoeff() > 0.0;
  if (diagonal) {
    inverse.diagonal() = covariance.diagonal().cwiseSqrt().cwiseInverse();
  } else {
    const Eigen::LLT<Eigen::MatrixXd> cholesky(covariance);
    positive = positive && cholesky.info() == Eigen::Success;
    cholesky.matrixL().solveInPlace(inverse);
  }
  if (!positive || !inverse.allFinite())
    throw std::invalid_argument(
        fmt::format("covariance of mixture component {} of {} features is not positive definite (smallest variance {})",
                    component, features, covariance.diagonal().minCoeff()));
  return inverse;
}

/// |W (x - mu)|^2 of every point of a block. F features, or Dynamic: the same code, but only a known number of features
/// lets the compiler unroll the inner loops and vectorise the outer one.
template <int F>
void squared_distance(const Eigen::MatrixXd& whitening, const double* mean, const double* points, Index features,
                      double* distance) {
  const Index count = F == Eigen::Dynamic ? features : F;
  const double* W = whitening.data();
  for (Index n = 0; n < block_size; ++n) {
    double sum = 0.0;
#pragma GCC unroll 8
    for (Index i = 0; i < count; ++i) {
      double whitened = 0.0;
#pragma GCC unroll 8
      for (Index j = 0; j <= i; ++j) whitened += W[i + j * count] * (points[n + j * block_size] - mean[j]);
      sum += whitened * whitened;
    }
    distance[n] = sum;
  }
}

/// The kernel for a number of features.
auto squared_distance_for(Index features) {
  switch (features) {
    case 1:
      return squared_distance<1>;
    case 2:
      return squared_distance<2>;
    case 3:
      return squared_distance<3>;
    case 4:
      return squared_distance<4>;
    case 5:
      return squared_distance<5>;
    case 6:
      return squared_distance<6>;
    case 7:
      return squared_distance<7>;
    case 8:
      return squared_distance<8>;
    default:
      return squared_distance<Eigen::Dynamic>;
  }
}

}  // namespace

ComponentFactors factor(const GaussianMixture& mixture) {
  const Index components = mixture.components();
  ComponentFactors factors;
  factors.means = mixture.means;
  factors.diagonal = mixture.type == CovarianceType::diagonal;
  factors.log_constants.resize(components);
  const double log_normal = -0.5 * static_cast<double>(mixture.features()) * std::log(2.0 * std::numbers::pi);
  for (Index k = 0; k < components; ++k) {
    factors.whitening.push_back(inverse_cholesky(mixture.covariances[k], factors.diagonal, k));
    const double log_weight = mixture.weights(k) > 0.0 ? std::log(mixture.weights(k)) : log_zero;
    factors.log_constants(k) = log_weight + factors.whitening[k].diagonal().array().log().sum() + log_normal;
  }
  return factors;
}

void evaluate(const ComponentFactors& factors, const Eigen::Ref<const BlockColumns>& points, BlockDensity& out) {
  const Index components = factors.log_constants.size(), features = factors.means.rows();
  out.relative.resize(block_size, components);
  assert(points.cols() == features && points.outerStride() == block_size);
  const auto distance_kernel = squared_distance_for(features);
  BlockColumn distance;
  BlockColumn& largest = out.log_density;
  for (Index k = 0; k < components; ++k) {
    distance_kernel(factors.whitening[k], factors.means.col(k).data(), points.data(), features, distance.data());
    // Where the parts of a distance overflow with different signs.
    if (std::isnan(distance.sum())) distance = distance.isNaN().select(largest_distance, distance);
    out.relative.col(k) = factors.log_constants(k) - 0.5 * distance.min(largest_distance);
    if (k == 0)
      largest = out.relative.col(k);
    else
      largest = largest.max(out.relative.col(k));
  }
  out.sum.setZero();
  for (Index k = 0; k < components; ++k) {
    auto relative = out.relative.col(k);
    relative = (relative - largest).max(smallest_log_ratio);
    block_exp(relative);
    out.sum += relative;
  }
  // Not Eigen's log, which is slower than the C library's in a portable build.
  out.log_density += out.sum.unaryExpr([](double sum) { return std::log(sum); });
}

}  // namespace modebank
