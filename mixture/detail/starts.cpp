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

/// Largest number of points from which a start is chosen.
constexpr Index start_points = 50000;
/// Upper limit of squared distances, because the squares of points far out overflow.
constexpr double largest_distance = 1e200;

BlockColumn squared_distances(const PointBlocks& points, Index block, const double* center) {
  BlockColumn distances = BlockColumn::Zero();
  for (Index f = 0; f < points.features(); ++f) distances += (points.points(block).col(f) - center[f]).square();
  return distances.min(largest_distance);
}

/// Sum of the weights of each block.
Eigen::VectorXd block_weights(const PointBlocks& points) {
  Eigen::VectorXd sums(points.blocks());
  for (Index b = 0; b < points.blocks(); ++b) sums(b) = points.weights(b).sum();
  return sums;
}

/// Index of a point drawn with probability proportional to its weight. `block_sums` is the result of block_weights.
Index draw(const PointBlocks& points, const Eigen::VectorXd& block_sums, std::mt19937_64& generator) {
  double rest = boost::random::uniform_01<double>()(generator) * block_sums.sum();
  Index last = 0;
  for (Index b = 0; b < points.blocks(); ++b) {
    if (rest >= block_sums(b) && b + 1 < points.blocks()) {
      rest -= block_sums(b);
      continue;
    }
    const auto weights = points.weights(b);
    for (Index i = 0; i < points.points_in(b); ++i) {
      if (!(weights(i) > 0.0)) continue;
      last = b * block_size + i;
      if (rest < weights(i)) return last;
      rest -= weights(i);
    }
  }
  return last;
}

Eigen::VectorXd point(const PointBlocks& points, Index index) {
  return points.points(index / block_size).row(index % block_size).matrix();
}

/// Cluster of every point, block_size x blocks. Entries of padding points are arbitrary.
using Labels = Eigen::Array<Index, block_size, Eigen::Dynamic>;

/// Nearest centre of every point; on a tie, the one with the lower index.
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

/// Moves the centres to the weighted means of their clusters; an empty cluster keeps its centre. Returns the clusters'
/// weights.
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

/// Weighted scatter (sum of w d d') of each cluster about its centre; its lower triangle only.
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

/// A start for EM from the moments of clusters. Each covariance is shrunk towards the pooled within-cluster covariance
/// with the strength of F + 1 points of mean weight. Each weight is shrunk towards 1/K with the strength of one point.
/// So a cluster without points, or with one point, also gives a usable start. An empty cluster stays at its column of
/// `centers` (F x K).
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

GaussianMixture random_start(const PointBlocks& points, Index components, const EmOptions& options,
                             std::mt19937_64& generator) {
  const Eigen::VectorXd block_sums = block_weights(points);
  Eigen::MatrixXd centers(points.features(), components);
  for (Index k = 0; k < components; ++k) centers.col(k) = point(points, draw(points, block_sums, generator));
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

GaussianMixture make_start(const ScaledCloud& cloud, Index components, int restart, const EmOptions& options,
                           std::uint64_t seed) {
  std::mt19937_64 generator = make_generator(seed, "em restart", static_cast<std::uint64_t>(restart));
  const PointBlocks chosen = cloud.points.for_starts(start_points, generator);
  GaussianMixture mixture = random_start(chosen, components, options, generator);
  cloud.set_noise(mixture);
  return mixture;
}

}  // namespace modebank
