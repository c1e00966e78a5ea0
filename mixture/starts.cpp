#include "mixture/starts.hpp"

#include <algorithm>
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
/// A start is the best of a few short runs, which miss a cluster far less often than a single one does, also where
/// split-and-merge moves follow: without them moves left poorer optima (a real cloud of twelve components, and one of
/// twelve seeds in tests/app/recovery_test.cpp). Who wants no moves wants it quick: one k-means++ start then, but not
/// for two components or beside a noise component, where it misses too much.
constexpr int short_runs = 5, short_run_iterations = 10;

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
  return fresh_start(components, generator);
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

/// emEM (Biernacki, Celeux & Govaert 2003, Comput. Stat. Data Anal. 41, section 2.2).
Start Starts::fresh_start(Index components, std::mt19937_64& generator) const {
  const auto start = options_.start == StartKind::random ? random_start : kmeans_start;
  const PointBlocks chosen = cloud_.points.for_starts(start_points, generator);
  const auto draw = [&](Index spare) {
    return with_noise(start(chosen, components + spare, options_.covariance, options_.covariance_floor, generator),
                      components);
  };
  const bool quick = options_.split_merge == 0 && components > 2 && options_.start != StartKind::random;
  if (!options_.noise_component && (components == 1 || quick)) return {draw(0), 0};
  EmOptions brief = options_;
  brief.max_iterations = std::min(short_run_iterations, options_.max_iterations);
  EmResult best;
  for (int run = 0; run < short_runs; ++run) {
    // Every other run thins more clusters out: it finds the noise where there is much, but may lose a mode.
    EmResult result = iterate(cloud_.points,
                              draw(options_.noise_component && run % 2 == 1 ? spare_components(components) : 0), brief);
    if (run == 0 || result.log_likelihood > best.log_likelihood) best = std::move(result);
  }
  return {std::move(best.mixture), best.iterations};
}

}  // namespace modebank
