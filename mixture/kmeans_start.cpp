#include "mixture/kmeans_start.hpp"

#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "mixture/em_step.hpp"
#include "mixture/kmeans_kernels.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// More of either cost more time than they save EM.
constexpr int lloyd_iterations = 3, candidates = 3;

/// A number for every point, and its weighted sum block by block.
struct WeightedColumn {
  AlignedBuffer values;
  Eigen::VectorXd block_sums;  ///< sum of weight times value

  explicit WeightedColumn(const PointBlocks& points)
      : values(points.blocks() * block_size), block_sums(Eigen::VectorXd::Zero(points.blocks())) {}
};

/// Squared distances to the nearest of `centers`, when `center` joins them.
void closer(const PointBlocks& points, const Eigen::Ref<const Eigen::VectorXd>& center, const WeightedColumn& nearest,
            WeightedColumn& out) {
  const auto kernel = em::kmeans_kernels().closer;
  AlignedBuffer stage = points.stage();
  for (Index b = 0; b < points.blocks(); ++b)
    out.block_sums(b) = kernel(points.block(b, stage), static_cast<int>(points.features()), center.data(),
                               nearest.values.data() + b * block_size, out.values.data() + b * block_size);
}

/// Index of a point drawn with probability proportional to its weight times `column` (filling points have none).
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
      const double mass = weights(i) * column.values.data()[b * block_size + i];
      if (!(mass > 0.0)) continue;
      last = b * block_size + i;
      if (rest < mass) return last;
      rest -= mass;
    }
  }
  return last;
}

Eigen::VectorXd point(const PointBlocks& points, Index index) {
  Eigen::VectorXd result(points.features());
  for (Index f = 0; f < points.features(); ++f) result(f) = points.coordinate(index, f);
  return result;
}

/// Every point counts with its weight alone.
WeightedColumn ones(const PointBlocks& points) {
  WeightedColumn result(points);
  std::fill_n(result.values.data(), points.blocks() * block_size, 1.0);
  for (Index b = 0; b < points.blocks(); ++b) result.block_sums(b) = points.weights(b).sum();
  return result;
}

/// k-means++ that draws a few candidates for every centre and keeps the one that leaves the least distances (Arthur &
/// Vassilvitskii 2007, section 5).
Eigen::MatrixXd plus_plus_centers(const PointBlocks& points, Index components, std::mt19937_64& generator) {
  const WeightedColumn equal = ones(points);
  WeightedColumn nearest(points), trial(points), best(points);
  std::fill_n(nearest.values.data(), points.blocks() * block_size, std::numeric_limits<double>::max());
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

/// Nearest centre of every point, the lower index on a tie.
void assign(const PointBlocks& points, const Eigen::MatrixXd& centers, BlockLabels& labels) {
  const auto kernel = em::kmeans_kernels().nearest;
  AlignedBuffer stage = points.stage();
  for (Index b = 0; b < points.blocks(); ++b)
    kernel(points.block(b, stage), static_cast<int>(points.features()), centers.data(),
           static_cast<int>(centers.cols()), labels.col(b).data());
}

/// Weighted means of the clusters; an empty one keeps its centre. Returns the clusters' weights.
Eigen::VectorXd recenter(const PointBlocks& points, const BlockLabels& labels, Eigen::MatrixXd& centers) {
  const Index features = centers.rows();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(1 + features, centers.cols());
  AlignedBuffer stage = points.stage();
  for (Index b = 0; b < points.blocks(); ++b) {
    const em::Block block = points.block(b, stage);
    for (Index i = 0; i < block_size; ++i) {
      double* const sum = sums.data() + labels(i, b) * (1 + features);
      const double weight = block.weights[i];
      sum[0] += weight;
      for (Index f = 0; f < features; ++f) sum[1 + f] += weight * block.points[f * block_size + i];
    }
  }
  for (Index k = 0; k < centers.cols(); ++k)
    if (sums(0, k) > 0.0) centers.col(k) = sums.col(k).tail(features) / sums(0, k);
  return sums.row(0);
}

/// Weighted scatter (sum of w d d') of each cluster about its centre.
std::vector<Eigen::MatrixXd> scatter(const PointBlocks& points, const BlockLabels& labels,
                                     const Eigen::MatrixXd& centers) {
  const Index features = centers.rows(), entries = features * (features + 1) / 2;
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(entries, centers.cols());
  Eigen::VectorXd offset(features);
  AlignedBuffer stage = points.stage();
  for (Index b = 0; b < points.blocks(); ++b) {
    const em::Block block = points.block(b, stage);
    for (Index i = 0; i < block_size; ++i) {
      const Index k = labels(i, b);
      const double* const center = centers.data() + k * features;
      double* sum = sums.data() + k * entries;
      for (Index f = 0; f < features; ++f) {
        offset(f) = block.points[f * block_size + i] - center[f];
        const double weighted = block.weights[i] * offset(f);
        for (Index g = 0; g <= f; ++g) *sum++ += weighted * offset(g);
      }
    }
  }
  std::vector<Eigen::MatrixXd> result(static_cast<std::size_t>(centers.cols()), Eigen::MatrixXd(features, features));
  for (Index k = 0; k < centers.cols(); ++k)
    for (Index f = 0, entry = 0; f < features; ++f)
      for (Index g = 0; g <= f; ++g, ++entry)
        result[static_cast<std::size_t>(k)](f, g) = result[static_cast<std::size_t>(k)](g, f) = sums(entry, k);
  return result;
}

}  // namespace

GaussianMixture mixture_of_clusters(const PointBlocks& points, const BlockLabels& labels, Eigen::MatrixXd centers,
                                    CovarianceType type, double floor) {
  GaussianMixture start;
  start.type = type;
  start.means = std::move(centers);
  const Eigen::VectorXd mass = recenter(points, labels, start.means);
  start.covariances = scatter(points, labels, start.means);
  Eigen::MatrixXd pooled = Eigen::MatrixXd::Zero(points.features(), points.features());
  for (const Eigen::MatrixXd& matrix : start.covariances) pooled += matrix / points.total_weight();
  const double mean_weight = points.total_weight() / static_cast<double>(points.count());
  const double strength = static_cast<double>(points.features() + 1) * mean_weight;
  for (Index k = 0; k < mass.size(); ++k) {
    start.covariances[k] = (start.covariances[k] + strength * pooled) / (mass(k) + strength);
    raise_to_floor(start.covariances[k], floor, type);
  }
  start.weights = (mass.array() + mean_weight) / (mass.array() + mean_weight).sum();
  return start;
}

GaussianMixture kmeans_start(const PointBlocks& points, Index components, CovarianceType type, double floor,
                             std::mt19937_64& generator) {
  Eigen::MatrixXd centers = plus_plus_centers(points, components, generator);
  BlockLabels labels = BlockLabels::Zero(block_size, points.blocks()), previous;
  for (int iteration = 0; iteration < lloyd_iterations; ++iteration) {
    previous = labels;
    assign(points, centers, labels);
    if (iteration > 0 && (labels == previous).all()) break;
    recenter(points, labels, centers);
  }
  return mixture_of_clusters(points, labels, std::move(centers), type, floor);
}

GaussianMixture random_start(const PointBlocks& points, Index components, CovarianceType type, double floor,
                             std::mt19937_64& generator) {
  const WeightedColumn equal = ones(points);
  Eigen::MatrixXd centers(points.features(), components);
  for (Index k = 0; k < components; ++k) centers.col(k) = point(points, draw(points, equal, generator));
  BlockLabels labels = BlockLabels::Zero(block_size, points.blocks());
  assign(points, centers, labels);
  return mixture_of_clusters(points, labels, std::move(centers), type, floor);
}

}  // namespace modebank
