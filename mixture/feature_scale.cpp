#include "mixture/feature_scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace modebank {

using Eigen::Index;

namespace {

constexpr double rounding_share = 1e-13;
constexpr double smallest_scale = 1e-150;
/// Squared standard deviations: at most 2.5 % of the points cannot dominate a standard deviation from nearer.
constexpr double far_out = 36.0;
/// Sums of sums of this many terms lose less to rounding.
constexpr Index chunk = 4096;

/// Weighted sums over points of what `term(i)` adds to a vector, chunk by chunk.
template <class Term>
Eigen::VectorXd sum_over(const PointSet& set, Index size, Term term) {
  Eigen::VectorXd total = Eigen::VectorXd::Zero(size), part(size);
  for (Index first = 0; first < set.count(); first += chunk) {
    part.setZero();
    for (Index i = first; i < std::min(first + chunk, set.count()); ++i) {
      const double weight = set.weights.size() > 0 ? set.weights(i) : 1.0;
      if (weight > 0.0) term(i, weight, part);
    }
    total += part;
  }
  return total;
}

bool counts(const PointSet& set, Index i) { return set.weights.size() == 0 || set.weights(i) > 0.0; }

/// Where the bulk of a feature's values lies.
struct Bulk {
  double median = 0.0, deviation = 0.0;
};

/// From the weighted quantiles at 2.5, 50 and 97.5 %, which in a normal distribution lie 3.92 standard deviations
/// apart. Of large clouds every second, third, ... point is enough.
Bulk bulk_of(const PointSet& set, Index feature) {
  constexpr Index most_points = 131072;
  const Index stride = 1 + (set.count() - 1) / most_points;
  std::vector<std::pair<double, double>> values;
  double total = 0.0;
  for (Index i = 0; i < set.count(); i += stride) {
    if (!counts(set, i)) continue;
    values.emplace_back(set.points(feature, i), set.weights.size() > 0 ? set.weights(i) : 1.0);
    total += values.back().second;
  }
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double share) {
    double sum = 0.0;
    for (const auto& [value, weight] : values)
      if ((sum += weight) >= share * total) return value;
    return values.back().first;
  };
  if (values.empty()) return {};
  return {quantile(0.5), (quantile(0.975) - quantile(0.025)) / 3.92};
}

/// A few points so far out that they are what the standard deviation measures would leave all others within the floor
/// of each other; then the bulk sets the unit. The variances of a component that holds both lie between the floor and
/// the feature's variance: they must not differ by more than double precision can hold.
void resist_outliers(const PointSet& set, Index feature, double floor, FeatureScale& scale) {
  constexpr double dominated = 20.0, most_ratio = 1e13;
  const double smallest_share = 1.0 / std::sqrt(most_ratio * floor);
  const Bulk bulk = bulk_of(set, feature);
  const double sd = scale.scale(feature);
  if (!(bulk.deviation > rounding_share * std::abs(bulk.median)) || bulk.deviation * dominated > sd) return;
  scale.center(feature) = bulk.median;
  scale.scale(feature) = std::max(bulk.deviation, smallest_share * sd);
  scale.inverse(feature) = 1.0 / scale.scale(feature);
}

}  // namespace

FeatureScale FeatureScale::identity(Index features) {
  return {Eigen::VectorXd::Zero(features), Eigen::VectorXd::Ones(features), Eigen::VectorXd::Ones(features)};
}

FeatureScale FeatureScale::near_one(const GaussianMixture& mixture) {
  FeatureScale result = identity(mixture.features());
  for (Index f = 0; f < mixture.features(); ++f) {
    double largest = 0.0;
    for (const Eigen::MatrixXd& covariance : mixture.covariances) largest = std::max(largest, covariance(f, f));
    if (!(largest > 0.0)) continue;
    result.scale(f) = std::ldexp(1.0, std::ilogb(largest) / 2);
    result.inverse(f) = 1.0 / result.scale(f);
  }
  return result;
}

FeatureScale FeatureScale::of(const PointSet& set, double floor) {
  const Index features = set.features();
  Eigen::VectorXd magnitude = Eigen::VectorXd::Zero(features);
  for (Index i = 0; i < set.count(); ++i)
    if (counts(set, i)) magnitude = magnitude.cwiseMax(set.points.col(i).cwiseAbs());
  // Relative to the magnitude, so that squares neither overflow nor underflow.
  const auto relative = [&](Index i, Index f) { return magnitude(f) > 0.0 ? set.points(f, i) / magnitude(f) : 0.0; };
  const Eigen::VectorXd sums = sum_over(set, features + 1, [&](Index i, double weight, Eigen::VectorXd& sum) {
    sum(features) += weight;
    for (Index f = 0; f < features; ++f) sum(f) += weight * relative(i, f);
  });
  const Eigen::VectorXd mean = sums.head(features) / sums(features);
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(features);  // squared offset
  const Eigen::VectorXd squares = sum_over(set, features, [&](Index i, double weight, Eigen::VectorXd& sum) {
    for (Index f = 0; f < features; ++f) {
      const double offset = relative(i, f) - mean(f), square = offset * offset;
      sum(f) += weight * square;
      largest(f) = std::max(largest(f), square);
    }
  });
  FeatureScale result = identity(features);
  for (Index f = 0; f < features; ++f) {
    const double deviation = std::sqrt(squares(f) / sums(features));
    result.center(f) = magnitude(f) * mean(f);
    const bool constant = !(deviation > rounding_share) || magnitude(f) * deviation < smallest_scale;
    if (!constant) result.scale(f) = magnitude(f) * deviation;
    result.inverse(f) = constant ? 0.0 : 1.0 / result.scale(f);
    if (!constant && largest(f) > far_out * deviation * deviation) resist_outliers(set, f, floor, result);
  }
  return result;
}

GaussianMixture FeatureScale::to_scaled(const GaussianMixture& mixture) const {
  GaussianMixture scaled = mixture;
  scaled.means = (mixture.means.colwise() - center).array().colwise() / scale.array();
  for (Eigen::MatrixXd& covariance : scaled.covariances)
    covariance = (covariance.array().colwise() / scale.array()).rowwise() / scale.transpose().array();
  if (mixture.noise.present()) {
    scaled.noise.lower = (mixture.noise.lower - center).cwiseQuotient(scale);
    scaled.noise.upper = (mixture.noise.upper - center).cwiseQuotient(scale);
  }
  return scaled;
}

GaussianMixture FeatureScale::to_physical(const GaussianMixture& mixture) const {
  GaussianMixture physical = mixture;
  physical.means = (mixture.means.array().colwise() * scale.array()).colwise() + center.array();
  for (Eigen::MatrixXd& covariance : physical.covariances)
    covariance = (covariance.array().colwise() * scale.array()).rowwise() * scale.transpose().array();
  if (mixture.noise.present()) {
    physical.noise.lower = mixture.noise.lower.cwiseProduct(scale) + center;
    physical.noise.upper = mixture.noise.upper.cwiseProduct(scale) + center;
  }
  return physical;
}

UniformNoise bounding_box(const PointSet& set, const FeatureScale& scale, double floor) {
  UniformNoise noise;
  noise.lower.setConstant(set.features(), std::numeric_limits<double>::infinity());
  noise.upper = -noise.lower;
  for (Index i = 0; i < set.count(); ++i) {
    if (!counts(set, i)) continue;
    noise.lower = noise.lower.cwiseMin(set.points.col(i));
    noise.upper = noise.upper.cwiseMax(set.points.col(i));
  }
  const Eigen::VectorXd middle = 0.5 * (noise.lower + noise.upper), half = std::sqrt(3.0 * floor) * scale.scale,
                        resolution = 4.0 * std::numeric_limits<double>::epsilon() * middle.cwiseAbs();
  noise.lower = noise.lower.cwiseMin(middle - half.cwiseMax(resolution));
  noise.upper = noise.upper.cwiseMax(middle + half.cwiseMax(resolution));
  return noise;
}

}  // namespace modebank
