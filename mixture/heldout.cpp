#include "mixture/heldout.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "ident/base/seed.hpp"
#include "mixture/detail/cloud.hpp"
#include "mixture/detail/whole_loop.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr Index most_groups = 5;

/// The runs that contain points, in run order.
std::vector<Index> distinct(std::vector<Index> runs) {
  std::sort(runs.begin(), runs.end());
  runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
  return runs;
}

/// Positions of the points in each group.
std::vector<std::vector<Index>> points_of_groups(const std::vector<Index>& run_of_point) {
  const std::vector<Index> runs = distinct(run_of_point);
  const Index count = heldout_groups(run_of_point);
  std::vector<std::vector<Index>> groups(count);
  for (std::size_t i = 0; i < run_of_point.size(); ++i) {
    const Index position = std::distance(runs.begin(), std::lower_bound(runs.begin(), runs.end(), run_of_point[i]));
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

Index heldout_groups(const std::vector<Index>& runs) {
  return std::min(most_groups, static_cast<Index>(distinct(runs).size()));
}

double difference_error(const HeldoutScore& a, const HeldoutScore& b) {
  const auto groups = static_cast<double>(a.sums.size());
  if (a.sums.size() < 2 || b.sums.size() != a.sums.size()) return not_a_number;
  const Eigen::ArrayXd difference = a.sums - b.sums, weight = a.weights;
  const double mean = difference.sum() / weight.sum();
  return std::sqrt(groups / (groups - 1.0) * (difference - mean * weight).square().sum()) / weight.sum();
}

HeldoutScore heldout_score(const PointSet& points, const std::vector<Index>& runs, Index components, EmOptions options,
                           std::uint64_t seed) {
  const std::vector<std::vector<Index>> groups = points_of_groups(runs);
  const Index count = std::ssize(groups);
  if (count < 2) return {};
  options.restarts = std::min(options.restarts, 2);
  options.split_merge = 0;
  HeldoutScore score{Eigen::VectorXd::Constant(count, not_a_number), Eigen::VectorXd::Constant(count, not_a_number)};
  tbb::parallel_for(Index(0), count, [&](Index g) {
    const std::vector<Index>& group = groups[static_cast<std::size_t>(g)];
    const std::vector<Index> rest = rest_of(group, points.count());
    if (std::ssize(rest) < components) return;
    const PointPart training(points, rest), left_out(points, group);
    if (training.weights.size() > 0 && !(training.weights.sum() > 0.0)) return;
    const EmResult fit =
        fit_em(training.set(), components, options, derive_seed(seed, "held out", static_cast<std::uint64_t>(g)));
    const Eigen::VectorXd density = log_density(fit.mixture, left_out.set());
    const Eigen::VectorXd weight =
        left_out.weights.size() > 0 ? left_out.weights : Eigen::VectorXd::Ones(density.size());
    score.sums(g) = weight.dot(density);
    score.weights(g) = weight.sum();
  });
  require_whole_loop();
  return score;
}

}  // namespace modebank
