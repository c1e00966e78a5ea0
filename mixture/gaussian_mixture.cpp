#include "mixture/gaussian_mixture.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <stdexcept>

#include "ident/base/linalg.hpp"
#include "mixture/detail/cloud.hpp"
#include "mixture/detail/density.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Checks the values of a mixture, in addition to check_sizes. Weights may have any sum, because the mixture may be a
/// part of another mixture.
void check_numbers(const GaussianMixture& mixture) {
  if (!mixture.means.allFinite() || !mixture.weights.allFinite() || mixture.weights.minCoeff() < 0.0)
    throw std::invalid_argument("the mixture has a mean or weight that is not finite, or a negative weight");
  if (mixture.noise.present() && !(mixture.noise.weight >= 0.0 && std::isfinite(mixture.noise.weight)))
    throw std::invalid_argument(
        fmt::format("noise component has the weight {}; expected a probability", mixture.noise.weight));
}

/// Evaluates a mixture block by block. With errors, units are chosen so that the mixture's numbers are near one.
class BlockEvaluation {
 public:
  BlockEvaluation(const GaussianMixture& mixture, const PointSet& set)
      : mixture_(mixture),
        set_(set),
        scale_(scale_for(mixture, set)),
        points_(PointSet(set.points, detail::no_weights, set.covariances), scale_, 0),
        factored_(scale_.to_scaled(mixture), set.has_errors()),
        memory_(factored_),
        stage_(points_.stage()) {}

  /// Calls visit(first, count) when the kernels' memory holds the results for points first to first + count - 1.
  template <class Visit>
  void each(Visit visit) {
    const em::Components components = factored_.components();
    for (Index b = 0; b < points_.blocks(); ++b) {
      em::Block block = points_.block(b, stage_);
      if (factored_.has_noise()) block.noise = noise_of(b);
      factored_.kernels().evaluate(components, block, memory_.scratch());
      visit(b * block_size, points_.points_in(b));
    }
  }
  const KernelScratch& memory() const { return memory_; }
  double log_jacobian() const { return scale_.log_jacobian(); }

 private:
  static FeatureScale scale_for(const GaussianMixture& mixture, const PointSet& set) {
    check_sizes(mixture);
    check_numbers(mixture);
    if (set.features() != mixture.features())
      throw std::invalid_argument(
          fmt::format("points have {} features, the mixture has {}", set.features(), mixture.features()));
    if (!set.points.allFinite()) throw std::invalid_argument("a mixture needs finite points for its evaluation");
    check_errors(set);
    return set.has_errors() ? FeatureScale::near_one(mixture) : FeatureScale::identity(set.features());
  }

  const double* noise_of(Index block) {
    const Index first = block * block_size;
    for (Index i = 0; i < points_.points_in(block); ++i)
      memory_.noise()[i] = mixture_.noise.contains(set_.points.col(first + i)) ? factored_.log_noise() : log_zero;
    return memory_.noise();
  }

  const GaussianMixture& mixture_;
  const PointSet& set_;
  FeatureScale scale_;
  PointBlocks points_;
  FactoredMixture factored_;
  KernelScratch memory_;
  AlignedBuffer stage_;
};

}  // namespace

Index GaussianMixture::parameter_count() const {
  const Index K = components(), F = features();
  return K - 1 + K * F + (type == CovarianceType::full ? K * F * (F + 1) / 2 : K * F) + (noise.present() ? 2 : 0);
}

void check_sizes(const GaussianMixture& mixture) {
  const Index K = mixture.components(), F = mixture.features();
  if (K < 1 || F < 1 || mixture.means.cols() != K || static_cast<Index>(mixture.covariances.size()) != K)
    throw std::invalid_argument(
        fmt::format("the mixture has {} weights, {} x {} means and {} covariances, which do not fit together", K, F,
                    mixture.means.cols(), mixture.covariances.size()));
  for (const Eigen::MatrixXd& covariance : mixture.covariances)
    if (covariance.rows() != F || covariance.cols() != F)
      throw std::invalid_argument(
          fmt::format("mixture of {} features has a {} x {} covariance", F, covariance.rows(), covariance.cols()));
  if (mixture.noise.present() && (mixture.noise.lower.size() != F || mixture.noise.upper.size() != F ||
                                  !(mixture.noise.upper.array() > mixture.noise.lower.array()).all()))
    throw std::invalid_argument(fmt::format("mixture of {} features has a noise component without a box", F));
}

void check_errors(const PointSet& set) {
  constexpr double rounding = 1e-8;
  if (!set.has_errors()) return;
  const Index F = set.features();
  if (set.covariances.rows() != F * F || set.covariances.cols() != set.count())
    throw std::invalid_argument(fmt::format("{} points of {} features are given {} x {} error covariances", set.count(),
                                            F, set.covariances.rows(), set.covariances.cols()));
  for (Index i = 0; i < set.count(); ++i) {
    const Eigen::Map<const Eigen::MatrixXd> S(set.covariances.col(i).data(), F, F);
    bool sound = S.allFinite() && S.diagonal().minCoeff() >= 0.0;
    for (Index f = 0; f < F && sound; ++f)
      for (Index g = 0; g < f && sound; ++g) {
        const double most = std::sqrt(S(f, f)) * std::sqrt(S(g, g));
        sound = std::abs(S(f, g) - S(g, f)) <= rounding * most && std::abs(S(f, g)) <= (1.0 + rounding) * most;
      }
    if (!sound)
      throw std::invalid_argument(fmt::format(
          "the error covariance of point {} is invalid: expected a finite, symmetric, positive semidefinite matrix",
          i));
  }
}

bool raise_to_floor(Eigen::MatrixXd& covariance, double floor, CovarianceType type) {
  if (type == CovarianceType::diagonal) {
    const Eigen::VectorXd variances = covariance.diagonal();
    covariance = variances.cwiseMax(floor).asDiagonal();
    return (variances.array() < floor).any();
  }
  Eigen::MatrixXd excess = covariance;
  excess.diagonal().array() -= floor;
  // If the matrix minus the floor is positive definite, every eigenvalue is above the floor, and no decomposition is
  // needed.
  if (Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(excess).info() == Eigen::Success) return false;
  const auto [values, vectors] = symmetric_eigen(covariance);
  covariance = vectors * values.cwiseMax(floor).asDiagonal() * vectors.transpose();
  covariance = (0.5 * (covariance + covariance.transpose())).eval();
  return true;
}

Eigen::VectorXd log_density(const GaussianMixture& mixture, const PointSet& points) {
  BlockEvaluation evaluation(mixture, points);
  Eigen::VectorXd result(points.count());
  evaluation.each([&](Index first, Index count) {
    result.segment(first, count) = evaluation.memory().log_density().head(count) + evaluation.log_jacobian();
  });
  return result;
}

void visit_responsibilities(const GaussianMixture& mixture, const PointSet& points,
                            const std::function<void(Index, const Eigen::Ref<const Eigen::MatrixXd>&)>& visit) {
  BlockEvaluation evaluation(mixture, points);
  Eigen::MatrixXd columns;
  evaluation.each([&](Index first, Index count) {
    const KernelScratch& memory = evaluation.memory();
    columns = (memory.relative().topRows(count).colwise() / memory.sum().head(count)).transpose().matrix();
    visit(first, columns);
  });
}

Eigen::MatrixXd responsibilities(const GaussianMixture& mixture, const PointSet& points) {
  Eigen::MatrixXd result(mixture.components(), points.count());
  visit_responsibilities(mixture, points, [&](Index first, const Eigen::Ref<const Eigen::MatrixXd>& block) {
    result.middleCols(first, block.cols()) = block;
  });
  return result;
}

Eigen::MatrixXd sample(const GaussianMixture& mixture, Index count, std::mt19937_64& generator) {
  check_sizes(mixture);
  check_numbers(mixture);
  const double noise = mixture.noise.present() ? mixture.noise.weight : 0.0, total = mixture.weights.sum() + noise;
  if (count < 0 || !(total > 0.0))
    throw std::invalid_argument(fmt::format("cannot sample {} points from weights that sum to {}", count, total));
  std::vector<Eigen::MatrixXd> factors;
  for (const Eigen::MatrixXd& covariance : mixture.covariances) {
    const Cholesky cholesky(covariance);
    if (!cholesky.definite())
      throw std::invalid_argument(
          fmt::format("cannot sample: covariance of component {} is not positive definite", factors.size()));
    factors.push_back(cholesky.L());
  }
  boost::random::uniform_01<double> uniform;
  boost::random::normal_distribution<double> normal;
  Eigen::MatrixXd points(mixture.features(), count);
  Eigen::VectorXd z(mixture.features());
  for (Index i = 0; i < count; ++i) {
    double rest = uniform(generator) * total;
    if (rest < noise) {
      for (Index f = 0; f < mixture.features(); ++f)
        points(f, i) = mixture.noise.lower(f) + uniform(generator) * (mixture.noise.upper(f) - mixture.noise.lower(f));
      continue;
    }
    rest -= noise;
    Index k = 0;
    while (k + 1 < mixture.components() && rest >= mixture.weights(k)) rest -= mixture.weights(k++);
    for (double& entry : z) entry = normal(generator);
    points.col(i) = mixture.means.col(k) + factors[k] * z;
  }
  return points;
}

}  // namespace modebank
