#include "mixture/em.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "mixture/detail/cloud.hpp"
#include "mixture/detail/iterate.hpp"
#include "mixture/detail/restarts.hpp"
#include "mixture/detail/starts.hpp"
#include "mixture/detail/step.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Larger coordinates have squares, and so covariances, beyond double precision.
constexpr double largest_coordinate = 1e150;
/// A smaller floor would vanish in the rounding of a covariance's largest eigenvalue.
constexpr double smallest_floor = 1e-10;

void check(const EmOptions& options) {
  if (options.restarts < 1 || options.split_merge < 0 || options.max_iterations < 0)
    throw std::invalid_argument(
        fmt::format("EM needs restarts >= 1, split_merge and max_iterations >= 0; given {}, {} and {}",
                    options.restarts, options.split_merge, options.max_iterations));
  if (!(options.covariance_floor >= smallest_floor && std::isfinite(options.covariance_floor)) ||
      std::isnan(options.tolerance))
    throw std::invalid_argument(fmt::format("EM needs a finite covariance_floor >= {} and a tolerance; given {} and {}",
                                            smallest_floor, options.covariance_floor, options.tolerance));
}

void check(const GaussianMixture& start, Index features) {
  check_sizes(start);
  if (start.features() != features)
    throw std::invalid_argument(
        fmt::format("points have {} features, but the start has {}", features, start.features()));
}

void order_by_weight(GaussianMixture& mixture) {
  std::vector<Index> order(mixture.components());
  std::iota(order.begin(), order.end(), Index(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return mixture.weights(a) > mixture.weights(b); });
  const GaussianMixture unordered = mixture;
  for (Index k = 0; k < mixture.components(); ++k) {
    mixture.weights(k) = unordered.weights(order[k]);
    mixture.means.col(k) = unordered.means.col(order[k]);
    mixture.covariances[k] = unordered.covariances[order[k]];
  }
}

void to_physical(const ScaledCloud& cloud, EmResult& result) {
  result.mixture = cloud.scale.to_physical(result.mixture);
  if (cloud.noise.present()) {  // copies the box of the noise component, so that rounding does not change it
    result.mixture.noise.lower = cloud.noise.lower;
    result.mixture.noise.upper = cloud.noise.upper;
  }
  result.log_likelihood += cloud.points.total_weight() * cloud.scale.log_jacobian();
}

/// A start in scaled units with the covariance type and floor of the options.
GaussianMixture usable_start(const GaussianMixture& start, const ScaledCloud& cloud, const EmOptions& options) {
  GaussianMixture scaled = cloud.scale.to_scaled(start);
  scaled.type = options.covariance;
  cloud.set_noise(scaled);
  for (Eigen::MatrixXd& covariance : scaled.covariances) {
    if (!covariance.allFinite()) throw std::invalid_argument("the start has a covariance that is not finite");
    raise_to_floor(covariance, options.covariance_floor, options.covariance);
  }
  if (!scaled.means.allFinite() || !(scaled.weights.minCoeff() >= 0.0))
    throw std::invalid_argument("the start has a mean or weight that is not finite, or a negative weight");
  return scaled;
}

}  // namespace

void check_points(const PointSet& set) {
  if (set.features() < 1 || set.count() < 1)
    throw std::invalid_argument(fmt::format("EM needs points, given {} x {}", set.features(), set.count()));
  if (!(set.points.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= largest_coordinate))
    throw std::invalid_argument(fmt::format("EM needs finite points of magnitude up to {}", largest_coordinate));
  check_errors(set);
  if (set.typical_error.size() > 0 && !(set.typical_error.size() == set.features() && set.typical_error.allFinite() &&
                                        set.typical_error.minCoeff() >= 0.0))
    throw std::invalid_argument(fmt::format(
        "EM of {} features needs one typical error per feature, finite and nonnegative, or none", set.features()));
  if (set.weights.size() == 0) return;
  if (set.weights.size() != set.count())
    throw std::invalid_argument(fmt::format("{} points have {} weights; expected one weight per point, or none",
                                            set.count(), set.weights.size()));
  if (!set.weights.allFinite() || set.weights.minCoeff() < 0.0 || !(set.weights.sum() > 0.0))
    throw std::invalid_argument("EM needs finite, nonnegative weights that are not all zero");
}

struct EmSweep::Prepared {
  EmOptions options;
  ScaledCloud cloud;

  Prepared(const PointSet& points, const EmOptions& given) : options(given), cloud(points, options) {}
};

EmSweep::EmSweep(const PointSet& points, const EmOptions& options) {
  check(options);
  check_points(points);
  prepared_ = std::make_unique<Prepared>(points, options);
}

EmSweep::~EmSweep() = default;

EmResult EmSweep::fit(Index components, std::uint64_t seed, const GaussianMixture* start) const {
  const ScaledCloud& cloud = prepared_->cloud;
  const EmOptions& options = prepared_->options;
  if (components < 1 || components > cloud.points.count())
    throw std::invalid_argument(
        fmt::format("EM of {} components needs 1 to {} (the number of points)", components, cloud.points.count()));
  if (start) check(*start, cloud.points.features());
  const auto start_of = [&](int i) {
    return i == 0 && start ? usable_start(*start, cloud, options) : make_start(cloud, components, i, options, seed);
  };
  EmResult result = best_of_restarts(cloud.points, start_of, options, seed);
  order_by_weight(result.mixture);
  to_physical(cloud, result);
  return result;
}

EmResult fit_em(const PointSet& points, Index components, const EmOptions& options, std::uint64_t seed) {
  return EmSweep(points, options).fit(components, seed);
}

EmResult fit_em(const PointSet& points, const GaussianMixture& start, const EmOptions& options) {
  check(options);
  check(start, points.features());
  check_points(points);
  const ScaledCloud cloud(points, options);
  EmResult result = iterate(cloud.points, usable_start(start, cloud, options), options);
  result.agreeing_restarts = 1;
  to_physical(cloud, result);
  return result;
}

}  // namespace modebank
