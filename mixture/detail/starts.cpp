#include "mixture/detail/starts.hpp"

#include <algorithm>
#include <boost/random/uniform_01.hpp>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "ident/base/seed.hpp"
#include "mixture/detail/iterate.hpp"
#include "mixture/detail/step.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Starts are chosen from this many points at most.
constexpr Index start_points = 50000;
/// Short runs take this many points: enough to tell a start that misses a cluster.
constexpr Index short_run_points = 1500;
constexpr int short_run_iterations = 10;
/// More of either cost more time than they save EM.
constexpr int lloyd_iterations = 3, candidates = 3;
/// Squared distances beyond this (points so far out that squares overflow) count as this.
constexpr double largest_distance = 1e200;

/// A number for every point, block_size x blocks, and its weighted sum block by block. What filling points have does
/// not matter: their weight is zero.
struct WeightedColumn {
  BlockColumns values;
  Eigen::VectorXd block_sums;  ///< sum of weight times value
};

WeightedColumn constant(const PointBlocks& points, double value) {
  WeightedColumn result{BlockColumns::Constant(block_size, points.blocks(), value), Eigen::VectorXd(points.blocks())};
  for (Index b = 0; b < points.blocks(); ++b) result.block_sums(b) = value * points.weights(b).sum();
  return result;
}

BlockColumn squared_distances(const PointBlocks& points, Index block, const double* center) {
  BlockColumn distances = BlockColumn::Zero();
  for (Index f = 0; f < points.features(); ++f) distances += (points.points(block).col(f) - center[f]).square();
  return distances.min(largest_distance);
}

/// Squared distances to the nearest of some centres, `nearest`, when `center` joins them.
void closer(const PointBlocks& points, const Eigen::VectorXd& center, const WeightedColumn& nearest,
            WeightedColumn& out) {
  for (Index b = 0; b < points.blocks(); ++b) {
    out.values.col(b) = squared_distances(points, b, center.data()).min(nearest.values.col(b));
    out.block_sums(b) = (points.weights(b) * out.values.col(b)).sum();
  }
}

/// Index of a point drawn with probability proportional to its weight times `column`.
Index draw(const PointBlocks& points, const WeightedColumn& column, std::mt19937_64& generator) {
  double rest = boost::random::uniform_01<double>()(generator) * column.block_sums.sum();
  Index last = 0;
  for (Index b = 0; b < points.blocks(); ++b) {
    if (rest >= column.block_sums(b) && b + 1 < points.blocks()) {
      rest -= column.block_sums(b);
      continue;
    }
    const auto weights = points.weights(b);
    for (Index i = 0; i < points.points_in(b); ++i) {
      const double mass = weights(i) * column.values(i, b);
      if (!(mass > 0.0)) continue;
      last = b * block_size + i;
      if (rest < mass) return last;
      rest -= mass;
    }
  }
  return last;
}

Eigen::VectorXd point(const PointBlocks& points, Index index) {
  return points.points(index / block_size).row(index % block_size).matrix();
}

/// k-means++ that draws a few candidates for every centre and keeps the one that leaves the least distances (Arthur &
/// Vassilvitskii 2007, section 5).
Eigen::MatrixXd plus_plus_centers(const PointBlocks& points, Index components, std::mt19937_64& generator) {
  const WeightedColumn equal = constant(points, 1.0);
  WeightedColumn nearest = constant(points, largest_distance), trial = nearest, best = nearest;
  Eigen::MatrixXd centers(points.features(), components);
  for (Index k = 0; k < components; ++k) {
    // All points coincide with a centre: any of them is as good.
    const bool any = k == 0 || !(nearest.block_sums.sum() > 0.0);
    for (int candidate = 0; candidate < (any ? 1 : candidates); ++candidate) {
      const Eigen::VectorXd center = point(points, draw(points, any ? equal : nearest, generator));
      closer(points, center, nearest, trial);
      if (candidate > 0 && !(trial.block_sums.sum() < best.block_sums.sum())) continue;
      centers.col(k) = center;
      std::swap(best, trial);
    }
    std::swap(nearest, best);
  }
  return centers;
}

/// Cluster of every point, block_size x blocks; what filling points say does not matter.
using Labels = Eigen::Array<Index, block_size, Eigen::Dynamic>;

/// Nearest centre of every point, the lower index on a tie.
Labels assign(const PointBlocks& points, const Eigen::MatrixXd& centers) {
  Labels labels = Labels::Zero(block_size, points.blocks());
  for (Index b = 0; b < points.blocks(); ++b) {
    BlockColumn nearest = squared_distances(points, b, centers.col(0).data());
    for (Index k = 1; k < centers.cols(); ++k) {
      const BlockColumn distances = squared_distances(points, b, centers.col(k).data());
      labels.col(b) = (distances < nearest).select(k, labels.col(b));
      nearest = nearest.min(distances);
    }
  }
  return labels;
}

/// Weighted means of the clusters; an empty one keeps its centre. Returns the clusters' weights.
Eigen::VectorXd recenter(const PointBlocks& points, const Labels& labels, Eigen::MatrixXd& centers) {
  const Index features = centers.rows();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(1 + features, centers.cols());
  for (Index b = 0; b < points.blocks(); ++b) {
    const auto x = points.points(b);
    const auto weights = points.weights(b);
    for (Index i = 0; i < block_size; ++i) {
      double* const sum = sums.data() + labels(i, b) * (1 + features);
      sum[0] += weights(i);
      for (Index f = 0; f < features; ++f) sum[1 + f] += weights(i) * x(i, f);
    }
  }
  for (Index k = 0; k < centers.cols(); ++k)
    if (sums(0, k) > 0.0) centers.col(k) = sums.col(k).tail(features) / sums(0, k);
  return sums.row(0);
}

/// Weighted scatter (sum of w d d') of each cluster about its centre, its lower triangle.
std::vector<Eigen::MatrixXd> scatter(const PointBlocks& points, const Labels& labels, const Eigen::MatrixXd& centers) {
  const Index features = centers.rows();
  std::vector<Eigen::MatrixXd> sums(static_cast<std::size_t>(centers.cols()),
                                    Eigen::MatrixXd::Zero(features, features));
  Eigen::VectorXd offset(features);
  for (Index b = 0; b < points.blocks(); ++b) {
    const auto x = points.points(b);
    const auto weights = points.weights(b);
    for (Index i = 0; i < block_size; ++i) {
      const double* const center = centers.data() + labels(i, b) * features;
      double* const sum = sums[static_cast<std::size_t>(labels(i, b))].data();
      for (Index f = 0; f < features; ++f) offset(f) = x(i, f) - center[f];
      for (Index g = 0; g < features; ++g) {
        const double weighted = weights(i) * offset(g);
        for (Index f = g; f < features; ++f) sum[g * features + f] += weighted * offset(f);
      }
    }
  }
  for (Eigen::MatrixXd& sum : sums) sum = sum.selfadjointView<Eigen::Lower>().toDenseMatrix();
  return sums;
}

/// The moments of clusters as a start for EM. Each cluster's covariance is drawn towards the pooled within-cluster one
/// with the strength of F + 1 mean-weight points (and its weight towards 1/K with one), so an empty or one-point
/// cluster is a usable start. An empty cluster stays at its column of `centers` (F x K).
GaussianMixture mixture_of_clusters(const PointBlocks& points, const Labels& labels, Eigen::MatrixXd centers,
                                    const EmOptions& options) {
  GaussianMixture start;
  start.type = options.covariance;
  start.means = std::move(centers);
  const Eigen::VectorXd mass = recenter(points, labels, start.means);
  start.covariances = scatter(points, labels, start.means);
  Eigen::MatrixXd pooled = Eigen::MatrixXd::Zero(points.features(), points.features());
  for (const Eigen::MatrixXd& matrix : start.covariances) pooled += matrix / points.total_weight();
  const double mean_weight = points.total_weight() / static_cast<double>(points.count());
  const double strength = static_cast<double>(points.features() + 1) * mean_weight;
  for (Index k = 0; k < mass.size(); ++k) {
    start.covariances[k] = (start.covariances[k] + strength * pooled) / (mass(k) + strength);
    raise_to_floor(start.covariances[k], options.covariance_floor, options.covariance);
  }
  start.weights = (mass.array() + mean_weight) / (mass.array() + mean_weight).sum();
  return start;
}

}  // namespace

GaussianMixture kmeans_start(const PointBlocks& points, Index components, const EmOptions& options,
                             std::mt19937_64& generator) {
  Eigen::MatrixXd centers = plus_plus_centers(points, components, generator);
  Labels labels, previous;
  for (int iteration = 0; iteration < lloyd_iterations; ++iteration) {
    previous = std::exchange(labels, assign(points, centers));
    if (iteration > 0 && (labels == previous).all()) break;
    recenter(points, labels, centers);
  }
  return mixture_of_clusters(points, labels, std::move(centers), options);
}

GaussianMixture random_start(const PointBlocks& points, Index components, const EmOptions& options,
                             std::mt19937_64& generator) {
  const WeightedColumn equal = constant(points, 1.0);
  Eigen::MatrixXd centers(points.features(), components);
  for (Index k = 0; k < components; ++k) centers.col(k) = point(points, draw(points, equal, generator));
  const Labels labels = assign(points, centers);
  return mixture_of_clusters(points, labels, std::move(centers), options);
}

Eigen::MatrixXd sample_points(const PointBlocks& points, Index most, std::mt19937_64& generator) {
  const PointBlocks chosen = points.for_starts(most, generator);
  Eigen::MatrixXd sample(points.features(), chosen.count());
  Index taken = 0;
  for (Index i = 0; i < chosen.count(); ++i)
    if (chosen.weights(i / block_size)(i % block_size) > 0.0) sample.col(taken++) = point(chosen, i);
  return sample.leftCols(taken);
}

Start make_start(const ScaledCloud& cloud, Index components, int restart, const EmOptions& options,
                 std::uint64_t seed) {
  std::mt19937_64 generator = make_generator(seed, "em restart", static_cast<std::uint64_t>(restart));
  const auto start = options.start == StartKind::random ? random_start : kmeans_start;
  const PointBlocks chosen = cloud.points.for_starts(start_points, generator);
  const auto draw_one = [&] {
    GaussianMixture mixture = start(chosen, components, options, generator);
    cloud.set_noise(mixture);
    return mixture;
  };
  if (options.start_runs == 1 || components == 1) return {draw_one(), 0};
  // A subsample does not know the points' errors.
  const bool few = cloud.points.count() <= short_run_points || cloud.points.has_errors();
  std::optional<PointBlocks> subsample;
  if (!few) subsample.emplace(cloud.points.for_starts(short_run_points, generator));
  EmOptions brief = options;
  brief.max_iterations = std::min(short_run_iterations, options.max_iterations);
  EmResult best;
  for (int run = 0; run < options.start_runs; ++run) {
    EmResult result = iterate(few ? cloud.points : *subsample, draw_one(), brief);
    if (run == 0 || result.log_likelihood > best.log_likelihood) best = std::move(result);
  }
  return {std::move(best.mixture), best.iterations};
}

}  // namespace modebank
