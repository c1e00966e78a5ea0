#include "mixture/split_merge.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "mixture/em_iteration.hpp"
#include "mixture/em_step.hpp"
#include "mixture/starts.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr Index moves_are_ranked_on = 1000;  // points
constexpr int short_run_iterations = 20;
constexpr int most_rounds = 10;
/// Each way of merging is tried with this many ways of splitting before the next one's turn.
constexpr std::size_t splits_per_merge = 3;
/// A gain below this per unit weight is the same optimum [nats].
constexpr double least_gain = 1e-5;

struct Pair {
  double score;
  Index first, second;
};

/// By the cosine between their responsibilities.
std::vector<Pair> pairs_by_likeness(const Eigen::MatrixXd& memberships) {
  const Eigen::MatrixXd products = memberships * memberships.transpose();
  std::vector<Pair> pairs;
  for (Index i = 0; i < products.rows(); ++i)
    for (Index j = i + 1; j < products.rows(); ++j) {
      const double norms = std::sqrt(products(i, i) * products(j, j));
      pairs.push_back({norms > 0.0 ? products(i, j) / norms : 1.0, i, j});
    }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.score > b.score; });
  return pairs;
}

/// By the divergence of the component's points, weighted by responsibility, from its density.
std::vector<Index> splits_by_misfit(const GaussianMixture& mixture, const Eigen::MatrixXd& points,
                                    const Eigen::MatrixXd& memberships) {
  Eigen::VectorXd misfit = Eigen::VectorXd::Zero(mixture.components());
  const Eigen::VectorXd density = log_density(mixture, points);
  for (Index k = 0; k < mixture.components(); ++k) {
    const double mass = memberships.row(k).sum();
    if (!(mass > 0.0) || !(mixture.weights(k) > 0.0)) continue;
    for (Index i = 0; i < points.cols(); ++i) {
      const double r = memberships(k, i);
      if (!(r > 0.0)) continue;
      // Responsibility times density is weight times the component's density.
      const double component = std::log(r) + density(i) - std::log(mixture.weights(k));
      misfit(k) += r / mass * (std::log(r / mass) - component);
    }
  }
  std::vector<Index> order(static_cast<std::size_t>(mixture.components()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return misfit(a) > misfit(b); });
  return order;
}

GaussianMixture pair_of(const GaussianMixture& mixture, Index i, Index j) {
  const double weight = mixture.weights(i) + mixture.weights(j);
  const double share = weight > 0.0 ? mixture.weights(j) / weight : 0.5;
  const Eigen::VectorXd gap = mixture.means.col(j) - mixture.means.col(i);
  GaussianMixture result;
  result.weights = Eigen::VectorXd::Constant(1, weight);
  result.means = mixture.means.col(i) + share * gap;
  result.covariances = {(1.0 - share) * mixture.covariances[static_cast<std::size_t>(i)] +
                        share * mixture.covariances[static_cast<std::size_t>(j)] +
                        share * (1.0 - share) * gap * gap.transpose()};
  if (mixture.type == CovarianceType::diagonal)
    result.covariances[0] = Eigen::MatrixXd(result.covariances[0].diagonal().asDiagonal());
  return result;
}

}  // namespace

std::vector<SplitMergeMove> split_merge_moves(const GaussianMixture& mixture, const Eigen::MatrixXd& points,
                                              Index most) {
  std::vector<SplitMergeMove> moves;
  if (mixture.components() < 3) return moves;
  const Eigen::MatrixXd memberships = responsibilities(mixture, points);
  const std::vector<Index> splits = splits_by_misfit(mixture, points, memberships);
  for (const Pair& pair : pairs_by_likeness(memberships)) {
    std::size_t taken = 0;
    for (const Index split : splits) {
      if (std::ssize(moves) == most) return moves;
      if (split == pair.first || split == pair.second || taken == splits_per_merge) continue;
      moves.push_back({pair.first, pair.second, split});
      ++taken;
    }
  }
  return moves;
}

GaussianMixture apply(const SplitMergeMove& move, const GaussianMixture& mixture) {
  GaussianMixture result = mixture;
  const GaussianMixture merged = pair_of(mixture, move.merged, move.absorbed);
  result.weights(move.merged) = merged.weights(0);
  result.means.col(move.merged) = merged.means.col(0);
  result.covariances[static_cast<std::size_t>(move.merged)] = merged.covariances[0];
  const auto split = static_cast<std::size_t>(move.split);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(mixture.covariances[split]);
  const Index last = mixture.features() - 1;
  // The two halves of a Gaussian cut through its mean: their means are sqrt(2 / pi) standard deviations off it.
  const double offset_squared = 2.0 / std::numbers::pi;
  const Eigen::VectorXd axis = eigen.eigenvectors().col(last) * std::sqrt(eigen.eigenvalues()(last));
  const Eigen::MatrixXd halved = mixture.covariances[split] - offset_squared * axis * axis.transpose();
  const Eigen::VectorXd offset = std::sqrt(offset_squared) * axis;
  result.means.col(move.split) = mixture.means.col(move.split) + offset;
  result.means.col(move.absorbed) = mixture.means.col(move.split) - offset;
  result.weights(move.split) = result.weights(move.absorbed) = 0.5 * mixture.weights(move.split);
  result.covariances[split] = halved;
  if (mixture.type == CovarianceType::diagonal)
    result.covariances[split] = Eigen::MatrixXd(halved.diagonal().asDiagonal());
  result.covariances[static_cast<std::size_t>(move.absorbed)] = result.covariances[split];
  return result;
}

EmResult split_and_merge(const PointBlocks& points, EmResult fit, const EmOptions& options) {
  if (options.split_merge < 1 || fit.mixture.components() < 3) return fit;
  const Eigen::MatrixXd sample = systematic_sample(points, moves_are_ranked_on, 0.0);
  EmOptions brief = options;
  brief.max_iterations = std::min(short_run_iterations, options.max_iterations);
  for (int round = 0; round < most_rounds; ++round) {
    EmResult best;
    best.log_likelihood = -std::numeric_limits<double>::infinity();
    for (const SplitMergeMove& move : split_merge_moves(fit.mixture, sample, options.split_merge)) {
      GaussianMixture start = apply(move, fit.mixture);
      for (Eigen::MatrixXd& covariance : start.covariances)
        raise_to_floor(covariance, options.covariance_floor, options.covariance);
      EmResult result = iterate(points, std::move(start), brief);
      if (result.log_likelihood > best.log_likelihood) best = std::move(result);
    }
    if (best.mixture.components() == 0) return fit;
    const int spent = best.iterations;
    if (!best.converged) best = iterate(points, std::move(best.mixture), options);
    best.iterations += spent;
    if (!(best.log_likelihood > fit.log_likelihood + least_gain * points.total_weight())) return fit;
    best.iterations += fit.iterations;
    fit = std::move(best);
  }
  return fit;
}

}  // namespace modebank
