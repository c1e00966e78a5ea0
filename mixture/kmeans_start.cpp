#include "mixture/kmeans_start.hpp"

#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "mixture/em_step.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr int lloyd_iterations = 10;

void squared_distance(const Eigen::Ref<const BlockColumns>& points, const Eigen::Ref<const Eigen::VectorXd>& center,
                      BlockColumn& distance) {
  distance = (points.col(0) - center(0)).square();
  for (Index f = 1; f < points.cols(); ++f) distance += (points.col(f) - center(f)).square();
}

/// Index of a point drawn with probability proportional to `mass` (filling points have none).
Index draw(const BlockColumns& mass, std::mt19937_64& generator) {
  boost::random::uniform_01<double> uniform;
  double rest = uniform(generator) * mass.sum();
  Index last = 0;
  for (Index i = 0; i < mass.size(); ++i) {
    if (!(mass(i) > 0.0)) continue;
    last = i;
    if (rest < mass(i)) break;
    rest -= mass(i);
  }
  return last;
}

BlockColumns all_weights(const PointBlocks& points) {
  BlockColumns weights(block_size, points.blocks());
  for (Index b = 0; b < points.blocks(); ++b) weights.col(b) = points.weights(b);
  return weights;
}

Eigen::VectorXd point(const PointBlocks& points, Index index) {
  Eigen::VectorXd result(points.features());
  for (Index f = 0; f < points.features(); ++f) result(f) = points.coordinate(index, f);
  return result;
}

Eigen::MatrixXd plus_plus_centers(const PointBlocks& points, Index components, std::mt19937_64& generator) {
  Eigen::MatrixXd centers(points.features(), components);
  BlockColumns nearest = BlockColumns::Constant(block_size, points.blocks(), std::numeric_limits<double>::infinity());
  const BlockColumns weights = all_weights(points);
  BlockColumns mass;
  BlockColumn distance;
  for (Index k = 0; k < components; ++k) {
    mass = k == 0 ? weights : BlockColumns(weights * nearest);
    // All points coincide with a centre: any of them is as good.
    if (!(mass.sum() > 0.0)) mass = weights;
    centers.col(k) = point(points, draw(mass, generator));
    for (Index b = 0; b < points.blocks(); ++b) {
      squared_distance(points.points(b), centers.col(k), distance);
      nearest.col(b) = nearest.col(b).min(distance);
    }
  }
  return centers;
}

/// Nearest centre of every point, the lower index on a tie.
void assign(const PointBlocks& points, const Eigen::MatrixXd& centers, BlockLabels& labels) {
  BlockColumn distance, nearest;
  for (Index b = 0; b < points.blocks(); ++b) {
    nearest.setConstant(std::numeric_limits<double>::infinity());
    for (Index k = 0; k < centers.cols(); ++k) {
      squared_distance(points.points(b), centers.col(k), distance);
      for (Index i = 0; i < block_size; ++i)
        labels(i, b) = distance(i) < nearest(i) ? static_cast<int>(k) : labels(i, b);
      nearest = nearest.min(distance);
    }
  }
}

/// Weighted means of the clusters; an empty one keeps its centre. Returns the clusters' weights.
Eigen::VectorXd recenter(const PointBlocks& points, const BlockLabels& labels, Eigen::MatrixXd& centers) {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(centers.cols());
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(centers.rows(), centers.cols());
  for (Index i = 0; i < points.count(); ++i) {
    const double weight = points.weight(i);
    mass(labels(i)) += weight;
    for (Index f = 0; f < centers.rows(); ++f) sums(f, labels(i)) += weight * points.coordinate(i, f);
  }
  for (Index k = 0; k < centers.cols(); ++k)
    if (mass(k) > 0.0) centers.col(k) = sums.col(k) / mass(k);
  return mass;
}

/// Weighted scatter (sum of w d d') of each cluster about its centre.
std::vector<Eigen::MatrixXd> scatter(const PointBlocks& points, const BlockLabels& labels,
                                     const Eigen::MatrixXd& centers) {
  const Index features = centers.rows();
  std::vector<Eigen::MatrixXd> result(centers.cols(), Eigen::MatrixXd::Zero(features, features));
  for (Index i = 0; i < points.count(); ++i) {
    const int k = labels(i);
    for (Index f = 0; f < features; ++f)
      for (Index g = 0; g <= f; ++g)
        result[k](f, g) +=
            points.weight(i) * (points.coordinate(i, f) - centers(f, k)) * (points.coordinate(i, g) - centers(g, k));
  }
  for (Eigen::MatrixXd& matrix : result) matrix = Eigen::MatrixXd(matrix.selfadjointView<Eigen::Lower>());
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
  const BlockColumns weights = all_weights(points);
  Eigen::MatrixXd centers(points.features(), components);
  for (Index k = 0; k < components; ++k) centers.col(k) = point(points, draw(weights, generator));
  BlockLabels labels = BlockLabels::Zero(block_size, points.blocks());
  assign(points, centers, labels);
  return mixture_of_clusters(points, labels, std::move(centers), type, floor);
}

}  // namespace modebank
