#include "mixture/detail/feature_scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace modebank {

using Eigen::Index;

namespace {

constexpr double rounding_share = 1e-13;
constexpr double smallest_scale = 1e-150;
/// A distance in standard deviations of the bulk. If at most 2.5 % of the points lie outside the bulk, points within
/// this distance cannot dominate the standard deviation.
constexpr double far_out = 6.0;
/// Number of terms per partial sum. Summing partial sums has smaller rounding errors.
constexpr Index chunk = 4096;

bool counts(const PointSet& set, Index i) { return set.weights.size() == 0 || set.weights(i) > 0.0; }

template <int F>
using Row = Eigen::Array<double, F, 1>;

/// Calls visit(weight, x) for each point of positive weight, and flush() after every chunk.
template <int F, class Visit, class Flush>
void each_point(const PointSet& set, Visit visit, Flush flush) {
  const Index features = set.features();
  const double *x = set.points.data(), *weights = set.weights.size() > 0 ? set.weights.data() : nullptr;
  for (Index i = 0; i < set.count(); ++i, x += features) {
    const double weight = weights ? weights[i] : 1.0;
    if (weight > 0.0) visit(weight, Eigen::Map<const Row<F>>(x, features));
    if ((i + 1) % chunk == 0 || i + 1 == set.count()) flush();
  }
}

/// The first pass over the points of positive weight.
struct Extent {
  double weight = 0.0;
  Eigen::ArrayXd lower, upper, mean;
};

template <int F>
Extent extent_of(const PointSet& set) {
  const Index features = set.features();
  constexpr double beyond = std::numeric_limits<double>::infinity();
  Row<F> lower = Row<F>::Constant(features, beyond), upper = -lower, part = Row<F>::Zero(features), sum = part;
  double weight_part = 0.0, weight_sum = 0.0;
  each_point<F>(
      set,
      [&](double weight, const auto& x) {
        weight_part += weight;
        part += weight * x;
        lower = lower.min(x);
        upper = upper.max(x);
      },
      [&] {
        weight_sum += std::exchange(weight_part, 0.0);
        sum += part;
        part.setZero();
      });
  return {weight_sum, lower, upper, sum / weight_sum};
}

/// The second pass: variances in units of 1 / `inverse_unit`.
template <int F>
Eigen::ArrayXd variances_of(const PointSet& set, const Extent& extent, const Eigen::ArrayXd& inverse_unit) {
  const Row<F> unit = inverse_unit, mean = extent.mean;
  Row<F> part = Row<F>::Zero(set.features()), sum = part;
  each_point<F>(
      set, [&](double weight, const auto& x) { part += weight * ((x - mean) * unit).square(); },
      [&] {
        sum += part;
        part.setZero();
      });
  return sum / extent.weight;
}

/// Calls action(std::integral_constant<int, F>()), with F known at compile time for few features.
template <class Action>
auto with_features(Index features, Action action) {
  switch (features) {
    case 1:
      return action(std::integral_constant<int, 1>());
    case 2:
      return action(std::integral_constant<int, 2>());
    case 3:
      return action(std::integral_constant<int, 3>());
    case 4:
      return action(std::integral_constant<int, 4>());
    default:
      return action(std::integral_constant<int, Eigen::Dynamic>());
  }
}

/// Centre and width of the bulk of a feature's values.
struct Bulk {
  double median = 0.0, deviation = 0.0;
};

/// The bulk from the weighted quantiles at 2.5, 50 and 97.5 %. In a normal distribution the outer two are 3.92 standard
/// deviations apart. Large clouds are thinned evenly.
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

/// The smallest allowed unit. A component's variance lies between the floor and the variance of the feature. The ratio
/// of floor and variance must be representable in double precision.
double smallest_unit(double sd, double floor) {
  constexpr double most_ratio = 1e13;
  return sd / std::sqrt(most_ratio * floor);
}

/// Uses the bulk's unit if a few far outliers determine the standard deviation. Otherwise the floor would exceed the
/// distances between all other points.
void resist_outliers(const PointSet& set, Index feature, double floor, FeatureScale& scale) {
  constexpr double dominated = 20.0;
  const Bulk bulk = bulk_of(set, feature);
  const double sd = scale.scale(feature);
  if (!(bulk.deviation > rounding_share * std::abs(bulk.median)) || bulk.deviation * dominated > sd) return;
  scale.center(feature) = bulk.median;
  scale.scale(feature) = std::max(bulk.deviation, smallest_unit(sd, floor));
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
  const Extent extent = with_features(features, [&](auto F) { return extent_of<F()>(set); });
  const Eigen::ArrayXd magnitude = extent.lower.abs().max(extent.upper.abs());
  // A unit near the magnitude of the values, so that squares neither overflow nor underflow.
  const Eigen::ArrayXd inverse_unit = magnitude.unaryExpr(
      [](double value) { return value > smallest_scale ? std::ldexp(1.0, -std::ilogb(value)) : 1.0; });
  const Eigen::ArrayXd deviation =
      with_features(features, [&](auto F) { return variances_of<F()>(set, extent, inverse_unit); }).sqrt() /
      inverse_unit;
  const Eigen::ArrayXd farthest = (extent.upper - extent.mean).max(extent.mean - extent.lower);
  FeatureScale result = identity(features);
  for (Index f = 0; f < features; ++f) {
    result.center(f) = extent.mean(f);
    const bool constant = !(deviation(f) > rounding_share * magnitude(f)) || deviation(f) < smallest_scale;
    if (!constant) result.scale(f) = deviation(f);
    result.inverse(f) = constant ? 0.0 : 1.0 / result.scale(f);
    if (!constant && farthest(f) > far_out * deviation(f)) resist_outliers(set, f, floor, result);
    const double error = set.typical_error.size() > 0 ? set.typical_error(f) : 0.0;
    if (error > 0.0) result.scale(f) = constant ? error : std::max(error, smallest_unit(deviation(f), floor));
    if (error > 0.0 && !constant) result.inverse(f) = 1.0 / result.scale(f);
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
