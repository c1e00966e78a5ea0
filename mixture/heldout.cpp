#include "mixture/heldout.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "ident/not_a_number.hpp"
#include "ident/seed.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr Index most_groups = 5;

/// The runs that have points, in run order.
std::vector<Index> distinct_runs(const FeatureCloud& cloud) {
  std::vector<Index> runs = cloud.runs;
  std::sort(runs.begin(), runs.end());
  runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
  return runs;
}

/// Positions of the points of every group.
std::vector<std::vector<Index>> points_of_groups(const FeatureCloud& cloud) {
  const std::vector<Index> runs = distinct_runs(cloud);
  const Index count = heldout_groups(cloud);
  std::vector<std::vector<Index>> groups(count);
  for (std::size_t i = 0; i < cloud.runs.size(); ++i) {
    const Index position = std::distance(runs.begin(), std::lower_bound(runs.begin(), runs.end(), cloud.runs[i]));
    groups[position % count].push_back(static_cast<Index>(i));
  }
  return groups;
}

/// Positions of all points that are not in `group`.
std::vector<Index> rest_of(const std::vector<Index>& group, Index points) {
  std::vector<bool> left_out(points, false);
  for (const Index i : group) left_out[i] = true;
  std::vector<Index> rest;
  for (Index i = 0; i < points; ++i)
    if (!left_out[i]) rest.push_back(i);
  return rest;
}

}  // namespace

Index heldout_groups(const FeatureCloud& cloud) {
  return std::min(most_groups, static_cast<Index>(distinct_runs(cloud).size()));
}

double heldout_score(const FeatureCloud& cloud, Index components, const EmOptions& options, std::uint64_t seed) {
  const std::vector<std::vector<Index>> groups = points_of_groups(cloud);
  const Index count = static_cast<Index>(groups.size());
  if (count < 2) return not_a_number;
  std::vector<double> sums(count, not_a_number);
  tbb::parallel_for(Index(0), count, [&](Index g) {
    const std::vector<Index> rest = rest_of(groups[g], cloud.points.cols());
    if (static_cast<Index>(rest.size()) < components) return;
    const FeatureCloud training = subset(cloud, rest), left_out = subset(cloud, groups[g]);
    const std::uint64_t group_seed = derive_seed(seed, "held out", static_cast<std::uint64_t>(g));
    const EmResult fit = fit_em(training.point_set(), components, options, group_seed);
    sums[g] = log_density(fit.mixture, left_out.point_set()).sum();
  });
  double sum = 0.0;
  for (const double group_sum : sums) sum += group_sum;
  return sum / static_cast<double>(cloud.points.cols());
}

}  // namespace modebank
