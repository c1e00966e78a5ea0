#include "mixture/gaussian_mixture.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <stdexcept>

#include "mixture/component_density.hpp"
#include "mixture/point_blocks.hpp"

namespace modebank {

using Eigen::Index;

namespace {

PointBlocks blocks_for(const GaussianMixture& mixture, const PointSet& set) {
  check_sizes(mixture);
  if (set.features() != mixture.features())
    throw std::invalid_argument(
        fmt::format("points have {} features, the mixture has {}", set.features(), mixture.features()));
  if (set.has_errors() || mixture.noise.present()) throw std::logic_error("not on this commit yet");
  return PointBlocks(set.points, Eigen::VectorXd());
}

}  // namespace

Index GaussianMixture::parameter_count() const {
  const Index K = components(), F = features();
  return K - 1 + K * F + (type == CovarianceType::full ? K * F * (F + 1) / 2 : K * F) + (noise.present() ? 2 : 0);
}

void check_sizes(const GaussianMixture& mixture) {
  const Index K = mixture.components(), F = mixture.features();
  if (K < 1 || F < 1 || mixture.means.cols() != K || static_cast<Index>(mixture.covariances.size()) != K)
    throw std::invalid_argument(fmt::format("mixture of {} weights, {} x {} means and {} covariances", K, F,
                                            mixture.means.cols(), mixture.covariances.size()));
  for (const Eigen::MatrixXd& covariance : mixture.covariances)
    if (covariance.rows() != F || covariance.cols() != F)
      throw std::invalid_argument(
          fmt::format("mixture of {} features has a {} x {} covariance", F, covariance.rows(), covariance.cols()));
}

Eigen::VectorXd log_density(const GaussianMixture& mixture, const PointSet& points) {
  const PointBlocks blocks = blocks_for(mixture, points);
  const ComponentFactors factors = factor(mixture);
  BlockDensity density;
  Eigen::VectorXd result(points.count());
  for (Index b = 0; b < blocks.blocks(); ++b) {
    evaluate(factors, blocks.points(b), density);
    result.segment(b * block_size, blocks.points_in(b)) = density.log_density.head(blocks.points_in(b));
  }
  return result;
}

void visit_responsibilities(const GaussianMixture& mixture, const PointSet& points,
                            const std::function<void(Index, const Eigen::Ref<const Eigen::MatrixXd>&)>& visit) {
  const PointBlocks blocks = blocks_for(mixture, points);
  const ComponentFactors factors = factor(mixture);
  BlockDensity density;
  Eigen::MatrixXd columns;
  for (Index b = 0; b < blocks.blocks(); ++b) {
    evaluate(factors, blocks.points(b), density);
    density.relative.colwise() /= density.sum;
    columns = density.relative.topRows(blocks.points_in(b)).transpose().matrix();
    visit(b * block_size, columns);
  }
}

Eigen::MatrixXd responsibilities(const GaussianMixture& mixture, const PointSet& points) {
  Eigen::MatrixXd result(mixture.components(), points.count());
  visit_responsibilities(mixture, points, [&](Index first, const Eigen::Ref<const Eigen::MatrixXd>& block) {
    result.middleCols(first, block.cols()) = block;
  });
  return result;
}

double classification_entropy(const GaussianMixture& mixture, const PointSet& points) {
  const auto term = [](double r) { return r > 0.0 ? r * std::log(r) : 0.0; };
  double sum = 0.0;
  visit_responsibilities(mixture, points, [&](Index, const Eigen::Ref<const Eigen::MatrixXd>& block) {
    sum -= block.unaryExpr(term).sum();
    if (mixture.noise.present()) sum -= (1.0 - block.colwise().sum().array()).max(0.0).unaryExpr(term).sum();
  });
  return sum;
}

Eigen::MatrixXd sample(const GaussianMixture& mixture, Index count, std::mt19937_64& generator) {
  check_sizes(mixture);
  std::vector<Eigen::MatrixXd> factors;
  for (const Eigen::MatrixXd& covariance : mixture.covariances) {
    const Eigen::LLT<Eigen::MatrixXd> cholesky(covariance);
    if (cholesky.info() != Eigen::Success)
      throw std::invalid_argument(
          fmt::format("cannot sample: covariance of component {} is not positive definite", factors.size()));
    factors.push_back(cholesky.matrixL());
  }
  boost::random::uniform_01<double> uniform;
  boost::random::normal_distribution<double> normal;
  Eigen::MatrixXd points(mixture.features(), count);
  Eigen::VectorXd z(mixture.features());
  for (Index i = 0; i < count; ++i) {
    double rest = uniform(generator) * mixture.weights.sum();
    Index k = 0;
    while (k + 1 < mixture.components() && rest >= mixture.weights(k)) rest -= mixture.weights(k++);
    for (double& entry : z) entry = normal(generator);
    points.col(i) = mixture.means.col(k) + factors[k] * z;
  }
  return points;
}

}  // namespace modebank
