#include "mixture/starts.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "ident/seed.hpp"
#include "mixture/em_iteration.hpp"
#include "mixture/kmeans_start.hpp"
#include "mixture/noise_start.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Agglomeration takes time with the square of this.
constexpr Index largest_subsample = 300;
/// k-means++ and random starts are chosen from this many points at most.
constexpr Index start_points = 50000;
/// Short runs take this many points: enough to tell a start that misses a cluster.
constexpr Index short_run_points = 1500;
constexpr int short_run_iterations = 10;
/// Of automatic starts one in so many is random: k-means++ alone favours the same optima.
constexpr int random_every = 2;

}  // namespace

Eigen::MatrixXd sample_points(const PointBlocks& points, Index most, std::mt19937_64& generator) {
  const PointBlocks chosen = points.for_starts(most, generator);
  Eigen::MatrixXd sample(points.features(), chosen.count());
  Index taken = 0;
  for (Index i = 0; i < chosen.count(); ++i) {
    if (!(chosen.weight(i) > 0.0)) continue;
    for (Index f = 0; f < points.features(); ++f) sample(f, taken) = chosen.coordinate(i, f);
    ++taken;
  }
  return sample.leftCols(taken);
}

Starts::Starts(const ScaledCloud& cloud, const EmOptions& options) : cloud_(cloud), options_(options) {
  const int trees = options.start == StartKind::hierarchical ? options.restarts
                    : options.start == StartKind::automatic  ? 1
                                                             : 0;
  // The same subsamples for every number of components.
  std::mt19937_64 generator = make_generator(0, "agglomeration");
  for (int i = 0; i < trees; ++i) {
    Eigen::MatrixXd subsample = sample_points(cloud.points, largest_subsample, generator);
    Agglomeration merges = agglomerate(subsample);
    trees_.push_back({std::move(subsample), std::move(merges)});
  }
}

Start Starts::make(Index components, int restart, std::uint64_t seed) const {
  if (restart < std::ssize(trees_)) return {hierarchical(trees_[static_cast<std::size_t>(restart)], components), 0};
  std::mt19937_64 generator = make_generator(seed, "em restart", static_cast<std::uint64_t>(restart));
  const bool random = options_.start == StartKind::random ||
                      (options_.start == StartKind::automatic && restart % random_every == random_every - 1);
  return fresh_start(components, random, options_.start_runs, generator);
}

GaussianMixture Starts::hierarchical(const Tree& tree, Index components) const {
  const PointBlocks sample(PointSet(tree.subsample), FeatureScale::identity(tree.subsample.rows()));
  const std::vector<int> clusters = tree.merges.labels(components);
  BlockLabels labels = BlockLabels::Zero(block_size, sample.blocks());
  std::copy(clusters.begin(), clusters.end(), labels.data());
  // With more components than points in the sample some are left over: they stay at its first points.
  Eigen::MatrixXd centers(sample.features(), components);
  for (Index k = 0; k < components; ++k) centers.col(k) = tree.subsample.col(k % sample.count());
  GaussianMixture start =
      mixture_of_clusters(sample, labels, std::move(centers), options_.covariance, options_.covariance_floor);
  return with_noise(std::move(start), components);
}

GaussianMixture Starts::with_noise(GaussianMixture start, Index components) const {
  if (start.components() > components) start = keep_densest(start, components);
  cloud_.set_noise(start);
  return start;
}

/// emEM (Biernacki, Celeux & Govaert 2003, Comput. Stat. Data Anal. 41, section 2.2), the short runs on a subsample.
/// Short runs miss a cluster far less often than single starts do, also where moves follow.
Start Starts::fresh_start(Index components, bool random, int runs, std::mt19937_64& generator) const {
  const auto start = random ? random_start : kmeans_start;
  const PointBlocks chosen = cloud_.points.for_starts(start_points, generator);
  const auto draw = [&](Index spare) {
    return with_noise(start(chosen, components + spare, options_.covariance, options_.covariance_floor, generator),
                      components);
  };
  if (runs == 1 || (components == 1 && !options_.noise_component)) return {draw(0), 0};
  // A subsample does not know the points' errors.
  const bool few = cloud_.points.count() <= short_run_points || cloud_.points.has_errors();
  std::optional<PointBlocks> subsample;
  if (!few) subsample.emplace(cloud_.points.for_starts(short_run_points, generator));
  EmOptions brief = options_;
  brief.max_iterations = std::min(short_run_iterations, options_.max_iterations);
  EmResult best;
  for (int run = 0; run < runs; ++run) {
    // Every other run thins more clusters out: it finds the noise where there is much, but may lose a mode.
    const Index spare = options_.noise_component && run % 2 == 1 ? spare_components(components) : 0;
    EmResult result = iterate(few ? cloud_.points : *subsample, draw(spare), brief);
    if (run == 0 || result.log_likelihood > best.log_likelihood) best = std::move(result);
  }
  return {std::move(best.mixture), best.iterations};
}

}  // namespace modebank
