#include "mixture/detail/split_merge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "ident/base/linalg.hpp"
#include "ident/base/seed.hpp"
#include "mixture/detail/iterate.hpp"
#include "mixture/detail/starts.hpp"
#include "mixture/detail/step.hpp"
#include "mixture/reduction.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr Index moves_are_ranked_on = 1500;  // points
constexpr int partial_iterations = 10, move_iterations = 15;
constexpr int most_move_rounds = 20;
/// Optima count as equal if their log-likelihoods per unit weight differ by less than this [nats].
constexpr double least_gain = 1e-5;

GaussianMixture pair_of(const GaussianMixture& mixture, Index k) {
  GaussianMixture pair;
  pair.type = mixture.type;
  pair.weights = Eigen::Vector2d(0.5, 0.5);
  pair.means = mixture.means.col(k).replicate(1, 2);
  pair.covariances.assign(2, mixture.covariances[static_cast<std::size_t>(k)]);
  return pair;
}

/// Splits a Gaussian by the plane through its mean across its longest axis. Each of the two components has the moments
/// of its half.
GaussianMixture halves(const GaussianMixture& mixture, Index k) {
  const auto [values, vectors] = symmetric_eigen(mixture.covariances[static_cast<std::size_t>(k)]);
  const Index longest = mixture.features() - 1;
  const Eigen::VectorXd offset =
      vectors.col(longest) * std::sqrt(2.0 / std::numbers::pi * std::max(0.0, values(longest)));
  GaussianMixture pair = pair_of(mixture, k);
  pair.means.col(0) += offset;
  pair.means.col(1) -= offset;
  for (Eigen::MatrixXd& covariance : pair.covariances) covariance -= offset * offset.transpose();
  return pair;
}

/// Splits a component into a dense core and a wide shell, for clouds with heavier tails than a Gaussian's.
GaussianMixture core_and_shell(const GaussianMixture& mixture, Index k) {
  constexpr double core = 0.1, shell = 1.9;  // factors of the variance; their mean is one, so the component keeps its
                                             // variance
  GaussianMixture pair = pair_of(mixture, k);
  pair.covariances[0] *= core;
  pair.covariances[1] *= shell;
  return pair;
}

void raise_all(GaussianMixture& mixture, const EmOptions& options) {
  for (Eigen::MatrixXd& covariance : mixture.covariances)
    raise_to_floor(covariance, options.covariance_floor, options.covariance);
}

/// The better of the two ways of splitting. Its gain over one component is per unit weight of the whole mixture.
SplitMergeMove best_split(const GaussianMixture& mixture, Index k, const Eigen::MatrixXd& points,
                          const Eigen::VectorXd& memberships, EmOptions options) {
  SplitMergeMove move;
  move.split = k;
  if (!((memberships.array() > 0.5).count() > 1)) return move;
  constexpr double belongs = 0.01;
  std::vector<Index> members;
  for (Index i = 0; i < points.cols(); ++i)
    if (memberships(i) > belongs) members.push_back(i);
  const Eigen::MatrixXd own_points = points(Eigen::all, members);
  const Eigen::VectorXd own_weights = memberships(members);
  const PointBlocks own(PointSet(own_points, own_weights), FeatureScale::identity(points.rows()));
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
    // Merges are sorted by cost, so each split needs only its first `most` merges. There are K^3 / 2 combinations.
    std::size_t kept = 0;
    for (const Merge& merge : merges) {
      if (kept == most) break;
      if (merge.first == k || merge.second == k) continue;
      ++kept;
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

namespace {

/// The sample of the cloud by which moves are ranked, with the densities of the present mixture.
struct Ranking {
  Eigen::MatrixXd points;       // F x n
  Eigen::MatrixXd memberships;  // K x n
  Eigen::VectorXd log_density;

  void look(const GaussianMixture& mixture) {
    memberships = responsibilities(mixture, points);
    log_density = modebank::log_density(mixture, points);
  }
};

/// Partial EM (Ueda et al. 2000, section 3.2): updates the three components that a move changes. The density of the
/// other components and the total weight of the three are held fixed. Returns the change of the mean log-likelihood on
/// the cloud.
double settle(const Ranking& ranking, const SplitMergeMove& move, const EmOptions& options, GaussianMixture& mixture) {
  const std::vector<Index> touched{move.merged, move.absorbed, move.split};
  const PointBlocks points(PointSet(ranking.points), FeatureScale::identity(ranking.points.rows()));
  AlignedBuffer rest(points.blocks() * block_size);
  for (Index i = 0; i < points.count(); ++i) {
    double others = mixture.noise.present() ? std::max(0.0, 1.0 - ranking.memberships.col(i).sum()) : 0.0;
    for (Index k = 0; k < mixture.components(); ++k)
      if (std::find(touched.begin(), touched.end(), k) == touched.end()) others += ranking.memberships(k, i);
    rest.data()[i] = ranking.log_density(i) + std::log(std::max(others, 1e-300));
  }
  GaussianMixture three;
  three.type = mixture.type;
  three.weights = mixture.weights(touched);
  three.means = mixture.means(Eigen::all, touched);
  for (const Index k : touched) three.covariances.push_back(mixture.covariances[static_cast<std::size_t>(k)]);
  const double weight = three.weights.sum();
  double log_likelihood = 0.0;
  for (int iteration = 0;; ++iteration) {
    const MixtureMoments moments = expect(points, three, rest.data());
    log_likelihood = moments.log_likelihood;
    if (iteration == partial_iterations) break;
    maximise(moments, options.covariance_floor, three);
    three.weights *= weight / three.weights.sum();
  }
  for (Index i = 0; i < std::ssize(touched); ++i)
    put(component_of(three, i), touched[static_cast<std::size_t>(i)], mixture);
  return (log_likelihood - ranking.log_density.sum()) / static_cast<double>(points.count());
}

struct Trial {
  GaussianMixture start;
  double gain;
};

/// The mixtures after the moves that still gain after partial EM, the best first. For points with errors this gain is
/// not required, because the sample ignores the errors.
std::vector<Trial> promising(const Ranking& ranking, const GaussianMixture& mixture, bool errors,
                             const EmOptions& options) {
  std::vector<Trial> trials;
  const auto most = static_cast<std::size_t>(options.split_merge);
  for (const SplitMergeMove& move : split_merge_moves(mixture, ranking.points, options, most)) {
    Trial trial{apply(move, mixture), move.gain};
    raise_all(trial.start, options);
    if (!errors) trial.gain = settle(ranking, move, options, trial.start);
    if (errors || trial.gain > 0.0) trials.push_back(std::move(trial));
  }
  std::stable_sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) { return a.gain > b.gain; });
  return trials;
}

}  // namespace

EmResult split_and_merge(const PointBlocks& points, EmResult fit, const EmOptions& options, std::uint64_t seed) {
  if (options.split_merge < 1 || options.max_iterations < 1 || fit.mixture.components() < 3) return fit;
  std::mt19937_64 generator = make_generator(seed, "split and merge");
  Ranking ranking{sample_points(points, moves_are_ranked_on, generator), {}, {}};
  EmOptions brief = options;
  brief.max_iterations = std::min(move_iterations, options.max_iterations);
  for (int round = 0; round < most_move_rounds; ++round) {
    ranking.look(fit.mixture);
    const double wanted = fit.log_likelihood + least_gain * points.total_weight();
    bool better = false;
    for (Trial& trial : promising(ranking, fit.mixture, points.has_errors(), options)) {
      EmResult result = iterate(points, std::move(trial.start), brief, Steps::extrapolated, wanted);
      if (!(result.log_likelihood > wanted)) continue;
      const int spent = fit.iterations + result.iterations;
      if (!result.converged) result = iterate(points, std::move(result.mixture), options, Steps::extrapolated);
      result.iterations += spent;
      fit = std::move(result);
      better = true;
      break;
    }
    if (!better) break;
  }
  return fit;
}

}  // namespace modebank
