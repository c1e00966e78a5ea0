#include "mixture/feature_scale.hpp"

#include <cmath>

namespace modebank {

using Eigen::Index;

namespace {

constexpr double rounding_share = 1e-13;
constexpr double smallest_scale = 1e-150;

}  // namespace

FeatureScale FeatureScale::of(const Eigen::MatrixXd& points, const Eigen::VectorXd& weights) {
  const Index features = points.rows();
  FeatureScale result;
  result.center.setZero(features);
  result.scale.setOnes(features);
  result.constant_.setConstant(features, true);
  const Eigen::VectorXd shares = weights / weights.sum();
  for (Index f = 0; f < features; ++f) {
    const double magnitude = points.row(f).cwiseAbs().maxCoeff();
    if (!(magnitude > 0.0)) continue;
    // Relative to the magnitude, so that squares neither overflow nor underflow.
    const Eigen::VectorXd relative = points.row(f).transpose() / magnitude;
    const double mean = shares.dot(relative);
    const double deviation = std::sqrt(shares.dot((relative.array() - mean).square().matrix()));
    result.center(f) = magnitude * mean;
    if (deviation <= rounding_share || magnitude * deviation < smallest_scale) continue;
    result.scale(f) = magnitude * deviation;
    result.constant_(f) = false;
  }
  return result;
}

Eigen::MatrixXd FeatureScale::to_scaled(const Eigen::MatrixXd& points) const {
  Eigen::MatrixXd scaled = (points.colwise() - center).array().colwise() / scale.array();
  for (Index f = 0; f < scale.size(); ++f)
    if (constant_(f)) scaled.row(f).setZero();
  return scaled;
}

GaussianMixture FeatureScale::to_scaled(const GaussianMixture& mixture) const {
  GaussianMixture scaled = mixture;
  scaled.means = (mixture.means.colwise() - center).array().colwise() / scale.array();
  for (Eigen::MatrixXd& covariance : scaled.covariances)
    covariance = (covariance.array().colwise() / scale.array()).rowwise() / scale.transpose().array();
  return scaled;
}

GaussianMixture FeatureScale::to_physical(const GaussianMixture& mixture) const {
  GaussianMixture physical = mixture;
  physical.means = (mixture.means.array().colwise() * scale.array()).colwise() + center.array();
  for (Eigen::MatrixXd& covariance : physical.covariances)
    covariance = (covariance.array().colwise() * scale.array()).rowwise() * scale.transpose().array();
  return physical;
}

}  // namespace modebank
