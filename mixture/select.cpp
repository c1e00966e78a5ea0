#include "mixture/select.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "ident/base/seed.hpp"
#include "ident/base/work_counter.hpp"
#include "mixture/criteria.hpp"
#include "mixture/detail/cloud.hpp"
#include "mixture/detail/whole_loop.hpp"
#include "mixture/reduction.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Number of points that represent a cloud of more than most_compared points. Comparing candidates on this number takes
/// a tenth of the time for 700,000 points.
constexpr Index compared_part = 50'000;

struct FittedCandidate {
  GaussianMixture mixture;
  Candidate row;
};

/// The inputs that are the same for all candidates.
struct Task {
  const PointSet& points;
  double effective_samples;  ///< 0 if all points are independent
  const SelectionOptions& options;
  std::uint64_t seed;
  const GaussianMixture* start;  ///< start of the first restart; may be null
  double total_weight;
  Index distinct_points;

  /// The seed depends on the candidate's number of components, not on its place in the table. So adding other
  /// candidates does not change the result.
  std::uint64_t seed_of(Index components) const {
    return derive_seed(seed, "mixture", static_cast<std::uint64_t>(components));
  }
};

/// The number of distinct points of positive weight; counting stops at `enough`.
Index count_distinct(const PointSet& set, Index enough) {
  std::vector<Index> found;
  for (Index i = 0; i < set.count() && std::ssize(found) < enough; ++i) {
    const bool weighted = set.weights.size() == 0 || set.weights(i) > 0.0;
    const auto same = [&](Index other) { return set.points.col(i) == set.points.col(other); };
    if (weighted && std::none_of(found.begin(), found.end(), same)) found.push_back(i);
  }
  return std::ssize(found);
}

/// The candidate numbers in increasing order, without duplicates.
std::vector<Index> sorted_components(const SelectionOptions& options) {
  std::vector<Index> components = options.components;
  std::sort(components.begin(), components.end());
  components.erase(std::unique(components.begin(), components.end()), components.end());
  if (components.empty() || components.front() < 1)
    throw std::invalid_argument("selection needs candidate numbers of components, each at least 1");
  return components;
}

Candidate unfitted(Candidate row, CandidateStatus status, std::string reason) {
  constexpr double worst = std::numeric_limits<double>::infinity();
  row.status = status;
  row.failed = std::move(reason);
  row.log_likelihood = -worst;
  row.bic = row.aic = row.bic_naive = worst;
  return row;
}

FittedCandidate fit_candidate(const Task& task, const EmSweep& sweep, Index components) {
  const SelectionOptions& options = task.options;
  Candidate row;
  row.components = components;
  row.covariance = options.em.covariance;
  row.restarts = options.em.restarts;
  row.effective_samples = task.effective_samples > 0.0 ? task.effective_samples : task.total_weight;
  if (components > task.distinct_points)
    return {{},
            unfitted(row, CandidateStatus::too_few_points,
                     fmt::format("only {} distinct points, fewer than components", task.distinct_points))};
  const bool given = task.start && task.start->components() == components;
  EmResult fit;
  try {
    fit = sweep.fit(components, task.seed_of(components), given ? task.start : nullptr);
  } catch (const NotPositiveDefinite& error) {
    return {{}, unfitted(row, CandidateStatus::failed, error.what())};
  }
  row.log_likelihood = fit.log_likelihood;
  row.parameters = fit.mixture.parameter_count();
  row.iterations = fit.iterations;
  row.converged = fit.converged;
  row.agreeing_restarts = fit.agreeing_restarts;
  row.floor_active = fit.floor_active;
  fill_criteria(row, task.total_weight);
  if (!std::isfinite(row.bic))
    return {{}, unfitted(row, CandidateStatus::failed, "its likelihood is not a finite number")};
  return {std::move(fit.mixture), row};
}

/// Runs the largest candidates first, because they take longest.
template <class Do>
void for_each_from_the_largest(Index count, Do action) {
  WorkCounter counter("candidates", static_cast<std::size_t>(count));
  tbb::parallel_for(
      tbb::blocked_range<Index>(0, count, 1),
      [&](const tbb::blocked_range<Index>& range) {
        for (Index i = range.begin(); i < range.end(); ++i) {
          action(count - 1 - i);
          counter.add();
        }
      },
      tbb::simple_partitioner());
  require_whole_loop();
}

std::vector<FittedCandidate> fit_all(const Task& task, const std::vector<Index>& components) {
  const EmSweep sweep(task.points, task.options.em);
  std::vector<FittedCandidate> fitted(components.size());
  for_each_from_the_largest(std::ssize(components), [&](Index i) {
    fitted[static_cast<std::size_t>(i)] = fit_candidate(task, sweep, components[static_cast<std::size_t>(i)]);
  });
  return fitted;
}

/// A sample of a large cloud for comparing candidates. The cloud is divided into equal shares, and each share gives one
/// point, in order.
std::optional<PointPart> part_to_compare(const PointSet& points, std::uint64_t seed) {
  if (points.count() <= most_compared) return {};
  std::mt19937_64 generator = make_generator(seed, "compared points");
  return PointPart(points, one_of_each_share(points.count(), compared_part, generator));
}

/// Fits to all points. The fit starts from the mixture that was chosen on a part of the points.
GaussianMixture fitted_to_all(const PointSet& points, const GaussianMixture& chosen, EmOptions options) {
  options.restarts = 1;
  options.split_merge = 0;
  return EmSweep(points, options).fit(chosen.components(), 0, &chosen).mixture;
}

[[noreturn]] void report_no_choice(const Task& task, const std::vector<Candidate>& candidates) {
  const Index fewest = candidates.front().components;
  if (fewest > task.distinct_points)
    throw DataError(
        fmt::format("mixture.components begins at {}, but {} of {} points are distinct: choose at "
                    "most {}",
                    fewest, task.distinct_points, task.points.count(), task.distinct_points));
  throw DataError(fmt::format("no candidate mixture has a finite BIC on {} points", task.points.count()));
}

void check_enough(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options) {
  const auto fewest = std::min_element(options.components.begin(), options.components.end());
  const Index points = cloud.points.cols();
  if (fewest == options.components.end() || *fewest <= points) return;
  const std::string fewer = points > 0 ? fmt::format("ask for at most {} components, or ", points) : "";
  throw DataError(
      fmt::format("mixture.components begins at {}, but {} of {} windows can be clustered: {}cluster more windows (a "
                  "prior for windows that are not excited, all ranks, shorter windows, more data)",
                  *fewest, points, fits.count(), fewer));
}

MixtureResult with_memberships(const FeatureCloud& cloud, const FeatureCloud& assigned, Index windows,
                               Selection selection) {
  MixtureResult result;
  result.clustered = std::ssize(cloud.windows);
  result.mixture = std::move(selection.mixture);
  result.feature_names = cloud.names;
  result.candidates = std::move(selection.candidates);
  result.compared = selection.compared;
  result.labels = Eigen::VectorXi::Constant(windows, -1);
  label_windows(result.mixture, cloud, result.labels);
  if (!assigned.windows.empty()) label_windows(result.mixture, assigned, result.labels);
  result.responsibilities = WindowResponsibilities(result.mixture, cloud, assigned, windows);
  return result;
}

}  // namespace

Selection select(const PointSet& points, double effective_samples, const SelectionOptions& options, std::uint64_t seed,
                 const GaussianMixture* start) {
  const std::vector<Index> components = sorted_components(options);
  if (points.count() == 0) throw DataError("there are no points to cluster");
  check_points(points);
  if (!(effective_samples >= 0.0) || !std::isfinite(effective_samples))
    throw std::invalid_argument(fmt::format(
        "effective_samples = {} is out of range: a finite number above 0, or 0 if all points are independent",
        effective_samples));
  const std::optional<PointPart> part = part_to_compare(points, seed);
  const PointSet compared = part ? part->set() : points;
  // Neighbouring points share samples, so the part counts as the same number of independent samples as all points.
  if (part) effective_samples = std::min(effective_samples, static_cast<double>(compared.count()));
  const double weight = compared.weights.size() > 0 ? compared.weights.sum() : static_cast<double>(compared.count());
  const Task task{
      compared, effective_samples, options, seed, start, weight, count_distinct(compared, components.back())};
  std::vector<FittedCandidate> fitted = fit_all(task, components);
  Selection result;
  result.compared = part ? compared.count() : 0;
  for (const FittedCandidate& candidate : fitted) result.candidates.push_back(candidate.row);
  const Index best = best_candidate(result.candidates);
  if (best < 0) report_no_choice(task, result.candidates);
  result.candidates[static_cast<std::size_t>(best)].selected = true;
  result.mixture = std::move(fitted[static_cast<std::size_t>(best)].mixture);
  if (part) result.mixture = fitted_to_all(points, result.mixture, options.em);
  return result;
}

MixtureResult select_mixture(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options,
                             std::uint64_t seed, const GaussianMixture* start, const FeatureCloud& assigned) {
  check_enough(fits, cloud, options);
  const double samples = effective_samples(cloud, fits.length, fits.step);
  return with_memberships(cloud, assigned, fits.count(), select(cloud.point_set(), samples, options, seed, start));
}

MixtureResult merge_components(MixtureResult result, Index most) {
  if (most < 1) throw std::invalid_argument("a mixture cannot be merged into " + std::to_string(most) + " components");
  Reduction reduction(std::move(result.mixture));
  while (reduction.components() > most) {
    const auto [into, absorbed] = reduction.merge_closest();
    result.responsibilities = std::move(result.responsibilities).merged(into, absorbed);
    for (int& label : result.labels)
      if (label == absorbed)
        label = static_cast<int>(into);
      else if (label > absorbed)
        --label;
  }
  result.mixture = reduction.mixture();
  return result;
}

std::ptrdiff_t most_components(const SelectionOptions& options) {
  return options.components.empty() ? 0 : *std::max_element(options.components.begin(), options.components.end());
}

}  // namespace modebank
