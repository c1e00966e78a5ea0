#include "mixture/split_merge.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "ident/seed.hpp"
#include "mixture/component_merge.hpp"
#include "mixture/em_iteration.hpp"
#include "mixture/em_step.hpp"
#include "mixture/starts.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr Index moves_are_ranked_on = 1500;  // points
constexpr int partial_iterations = 15, move_iterations = 15;
constexpr int most_move_rounds = 20;
/// A gain below this per unit weight is the same optimum [nats].
constexpr double least_gain = 1e-5;

GaussianMixture pair_of(const GaussianMixture& mixture, Index k) {
  GaussianMixture pair;
  pair.type = mixture.type;
  pair.weights = Eigen::Vector2d(0.5, 0.5);
  pair.means = mixture.means.col(k).replicate(1, 2);
  pair.covariances.assign(2, mixture.covariances[static_cast<std::size_t>(k)]);
  return pair;
}

/// The moments of a Gaussian's halves on either side of a plane through its mean across its longest axis.
GaussianMixture halves(const GaussianMixture& mixture, Index k) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(mixture.covariances[static_cast<std::size_t>(k)]);
  const Index longest = mixture.features() - 1;
  const Eigen::VectorXd offset = eigen.eigenvectors().col(longest) *
                                 std::sqrt(2.0 / std::numbers::pi * std::max(0.0, eigen.eigenvalues()(longest)));
  GaussianMixture pair = pair_of(mixture, k);
  pair.means.col(0) += offset;
  pair.means.col(1) -= offset;
  for (Eigen::MatrixXd& covariance : pair.covariances) covariance -= offset * offset.transpose();
  return pair;
}

/// For clouds with a dense centre and heavier tails than a Gaussian's.
GaussianMixture core_and_shell(const GaussianMixture& mixture, Index k) {
  constexpr double core = 0.1, shell = 1.9;  // variances; their mean is the component's
  GaussianMixture pair = pair_of(mixture, k);
  pair.covariances[0] *= core;
  pair.covariances[1] *= shell;
  return pair;
}

void raise_all(GaussianMixture& mixture, const EmOptions& options) {
  for (Eigen::MatrixXd& covariance : mixture.covariances)
    raise_to_floor(covariance, options.covariance_floor, options.covariance);
}

/// The better of both ways of splitting, with its gain over one component per unit weight of the whole mixture.
SplitMergeMove best_split(const GaussianMixture& mixture, Index k, const Eigen::MatrixXd& points,
                          const Eigen::VectorXd& memberships, EmOptions options) {
  SplitMergeMove move;
  move.split = k;
  if (!((memberships.array() > 0.5).count() > 1)) return move;
  const PointBlocks own(PointSet(points, memberships), FeatureScale::identity(points.rows()));
  GaussianMixture alone;
  alone.type = mixture.type;
  alone.weights = Eigen::VectorXd::Ones(1);
  alone.means = mixture.means.col(k);
  alone.covariances = {mixture.covariances[static_cast<std::size_t>(k)]};
  options.max_iterations = 1;
  const double before = iterate(own, std::move(alone), options).log_likelihood;
  options.max_iterations = partial_iterations;
  for (GaussianMixture pair : {halves(mixture, k), core_and_shell(mixture, k)}) {
    raise_all(pair, options);
    EmResult result = iterate(own, std::move(pair), options);
    const double gain = (result.log_likelihood - before) / static_cast<double>(points.cols());
    if (move.parts.components() == 0 || gain > move.gain) {
      move.gain = gain;
      move.parts = std::move(result.mixture);
    }
  }
  return move;
}

}  // namespace

std::vector<SplitMergeMove> split_merge_moves(const GaussianMixture& mixture, const Eigen::MatrixXd& points,
                                              const EmOptions& options, std::size_t most) {
  std::vector<SplitMergeMove> moves;
  if (mixture.components() < 3) return moves;
  const Eigen::MatrixXd memberships = responsibilities(mixture, points);
  const std::vector<Merge> merges = merges_by_loss(mixture);
  for (Index k = 0; k < mixture.components(); ++k) {
    const SplitMergeMove split = best_split(mixture, k, points, memberships.row(k), options);
    if (split.parts.components() == 0) continue;
    for (const Merge& merge : merges) {
      if (merge.first == k || merge.second == k) continue;
      moves.push_back(split);
      moves.back().merged = merge.first;
      moves.back().absorbed = merge.second;
      moves.back().gain -= merge.loss;
    }
  }
  std::stable_sort(moves.begin(), moves.end(),
                   [](const SplitMergeMove& a, const SplitMergeMove& b) { return a.gain > b.gain; });
  if (moves.size() > most) moves.resize(most);
  return moves;
}

GaussianMixture apply(const SplitMergeMove& move, const GaussianMixture& mixture) {
  GaussianMixture result = mixture;
  put(merged(mixture, move.merged, move.absorbed), move.merged, result);
  for (const auto& [place, part] : {std::pair{move.split, Index{0}}, {move.absorbed, Index{1}}}) {
    put(component_of(move.parts, part), place, result);
    result.weights(place) *= mixture.weights(move.split);
  }
  return result;
}

EmResult split_and_merge(const PointBlocks& points, EmResult fit, const EmOptions& options) {
  if (options.split_merge < 1 || fit.mixture.components() < 3) return fit;
  std::mt19937_64 generator = make_generator(0, "split and merge");
  const Eigen::MatrixXd sample = sample_points(points, moves_are_ranked_on, generator);
  EmOptions brief = options;
  brief.max_iterations = std::min(move_iterations, options.max_iterations);
  for (int round = 0; round < most_move_rounds; ++round) {
    EmResult best;
    best.log_likelihood = -std::numeric_limits<double>::infinity();
    for (const SplitMergeMove& move :
         split_merge_moves(fit.mixture, sample, options, static_cast<std::size_t>(options.split_merge))) {
      GaussianMixture start = apply(move, fit.mixture);
      raise_all(start, options);
      EmResult result = iterate(points, std::move(start), brief);
      if (result.log_likelihood > best.log_likelihood) best = std::move(result);
    }
    if (best.mixture.components() == 0) return fit;
    const int spent = best.iterations;
    if (!best.converged) {
      best = iterate(points, std::move(best.mixture), options);
      best.iterations += spent;
    }
    if (!(best.log_likelihood > fit.log_likelihood + least_gain * points.total_weight())) return fit;
    best.iterations += fit.iterations;
    fit = std::move(best);
  }
  return fit;
}

}  // namespace modebank
