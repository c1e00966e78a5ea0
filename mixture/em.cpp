#include "mixture/em.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "ident/seed.hpp"
#include "mixture/em_step.hpp"
#include "mixture/feature_scale.hpp"
#include "mixture/kmeans_start.hpp"
#include "mixture/noise_start.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Covariances of squared coordinates beyond this cannot be represented.
constexpr double largest_coordinate = 1e150;
/// Below this the floor is lost in the rounding of a covariance's largest eigenvalue.
constexpr double smallest_floor = 1e-10;
constexpr double agreement_per_point = 1e-4;
/// Each restart goes on from the best of a few short runs, which miss a cluster far less often than a single start
/// does.
constexpr int short_runs = 5, short_run_iterations = 10;
/// Starts are chosen from this many points at most.
constexpr Index start_points = 50000;
constexpr double noise_start = 0.05;

void check(const EmOptions& options) {
  if (options.restarts < 1 || options.max_iterations < 0 || !(options.covariance_floor >= smallest_floor))
    throw std::invalid_argument(
        fmt::format("EM needs restarts >= 1, max_iterations >= 0 and covariance_floor >= {}; given {}, {} and {}",
                    smallest_floor, options.restarts, options.max_iterations, options.covariance_floor));
}

void check(const PointSet& set) {
  if (set.features() < 1 || set.count() < 1)
    throw std::invalid_argument(fmt::format("EM needs points, given {} x {}", set.features(), set.count()));
  if (!(set.points.array().abs() <= largest_coordinate).all())
    throw std::invalid_argument(fmt::format("EM needs finite points of magnitude up to {}", largest_coordinate));
  check_errors(set);
  if (set.weights.size() == 0) return;
  if (set.weights.size() != set.count())
    throw std::invalid_argument(fmt::format("EM is given {} points but {} weights", set.count(), set.weights.size()));
  if (!set.weights.allFinite() || set.weights.minCoeff() < 0.0 || !(set.weights.sum() > 0.0))
    throw std::invalid_argument("EM needs finite, nonnegative weights that are not all zero");
}

/// The cloud in the units it is fitted in.
struct ScaledCloud {
  FeatureScale scale;
  PointBlocks points;
  UniformNoise noise;  ///< physical units; absent unless asked for

  ScaledCloud(const PointSet& set, const EmOptions& options) : scale(FeatureScale::of(set)), points(set, scale) {
    if (!options.noise_component) return;
    noise = bounding_box(set, scale, options.covariance_floor);
    noise.weight = noise_start;
  }

  /// Gives a mixture in scaled units the noise component that was asked for, and no other.
  void set_noise(GaussianMixture& scaled) const {
    const double kept = scaled.noise.weight > 0.0 ? scaled.noise.weight : noise.weight;
    GaussianMixture box = scaled;
    box.noise = noise;
    scaled.noise = scale.to_scaled(box).noise;
    if (noise.present()) scaled.noise.weight = kept;
    scaled.weights *= (1.0 - (noise.present() ? kept : 0.0)) / scaled.weights.sum();
  }
};

/// Iterates from `start` (scaled units). The result's log-likelihood belongs to the result's mixture: the last pass
/// only measures it.
EmResult iterate(const PointBlocks& points, GaussianMixture start, const EmOptions& options) {
  EmResult result;
  result.mixture = std::move(start);
  double previous = -std::numeric_limits<double>::infinity();
  while (true) {
    const MixtureMoments moments = expect(points, result.mixture);
    result.log_likelihood = moments.log_likelihood;
    result.converged = result.log_likelihood - previous < options.tolerance * points.total_weight();
    if (result.converged || result.iterations == options.max_iterations) break;
    previous = result.log_likelihood;
    result.floor_active = maximise(moments, options.covariance_floor, result.mixture);
    ++result.iterations;
  }
  return result;
}

/// emEM (Biernacki, Celeux & Govaert 2003, Comput. Stat. Data Anal. 41, section 2.2).
EmResult restart(const ScaledCloud& cloud, Index components, const EmOptions& options, std::mt19937_64& generator) {
  const PointBlocks& points = cloud.points;
  const PointBlocks starts = points.for_starts(start_points, generator);
  EmOptions brief = options;
  brief.max_iterations = std::min(short_run_iterations, options.max_iterations);
  EmResult best;
  const bool one_start = components == 1 && !options.noise_component;
  for (int run = 0; run < (one_start ? 1 : short_runs); ++run) {
    const Index spare = options.noise_component ? spare_components(components) : 0;
    GaussianMixture start =
        kmeans_start(starts, components + spare, options.covariance, options.covariance_floor, generator);
    if (spare > 0) start = keep_densest(start, components);
    cloud.set_noise(start);
    EmResult result = iterate(points, std::move(start), brief);
    if (run == 0 || result.log_likelihood > best.log_likelihood) best = std::move(result);
  }
  if (best.converged) return best;
  EmOptions rest = options;
  rest.max_iterations -= best.iterations;
  EmResult result = iterate(points, std::move(best.mixture), rest);
  result.iterations += best.iterations;
  return result;
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
  if (cloud.noise.present()) {  // to the last bit
    result.mixture.noise.lower = cloud.noise.lower;
    result.mixture.noise.upper = cloud.noise.upper;
  }
  result.log_likelihood += cloud.points.total_weight() * cloud.scale.log_jacobian();
}

/// The best of the restarts, the first on a tie, with the number that agree with it.
EmResult best_of(std::vector<EmResult> restarts, double total_weight) {
  const auto best = std::max_element(restarts.begin(), restarts.end(), [](const EmResult& a, const EmResult& b) {
    return a.log_likelihood < b.log_likelihood;
  });
  const double agreeing = best->log_likelihood - agreement_per_point * total_weight;
  best->agreeing_restarts = static_cast<int>(std::count_if(
      restarts.begin(), restarts.end(), [&](const EmResult& result) { return result.log_likelihood >= agreeing; }));
  return std::move(*best);
}

/// A start in scaled units that obeys the options: their covariance type and floor.
GaussianMixture usable_start(const GaussianMixture& start, const ScaledCloud& cloud, const EmOptions& options) {
  GaussianMixture scaled = cloud.scale.to_scaled(start);
  scaled.type = options.covariance;
  cloud.set_noise(scaled);
  for (Eigen::MatrixXd& covariance : scaled.covariances) {
    if (!covariance.allFinite()) throw std::invalid_argument("EM is given a start whose covariance is not finite");
    raise_to_floor(covariance, options.covariance_floor, options.covariance);
  }
  if (!scaled.means.allFinite() || !(scaled.weights.minCoeff() >= 0.0))
    throw std::invalid_argument("EM is given a start with a mean or weight that is not finite, or a negative weight");
  return scaled;
}

}  // namespace

EmResult fit_em(const PointSet& points, Index components, const EmOptions& options, std::uint64_t seed) {
  check(options);
  if (components < 1 || components > points.count())
    throw std::invalid_argument(
        fmt::format("EM of {} components needs 1 to {} (the number of points)", components, points.count()));
  check(points);
  const ScaledCloud cloud(points, options);
  std::vector<EmResult> restarts(options.restarts);
  tbb::parallel_for(0, options.restarts, [&](int i) {
    std::mt19937_64 generator = make_generator(seed, "em restart", static_cast<std::uint64_t>(i));
    restarts[i] = restart(cloud, components, options, generator);
  });
  EmResult result = best_of(std::move(restarts), cloud.points.total_weight());
  order_by_weight(result.mixture);
  to_physical(cloud, result);
  return result;
}

EmResult fit_em(const PointSet& points, const GaussianMixture& start, const EmOptions& options) {
  check(options);
  check_sizes(start);
  if (start.features() != points.features())
    throw std::invalid_argument(
        fmt::format("EM is given points of {} features and a start of {}", points.features(), start.features()));
  check(points);
  const ScaledCloud cloud(points, options);
  EmResult result = iterate(cloud.points, usable_start(start, cloud, options), options);
  result.agreeing_restarts = 1;
  to_physical(cloud, result);
  return result;
}

}  // namespace modebank
