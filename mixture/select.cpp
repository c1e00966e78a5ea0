#include "mixture/select.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "ident/error.hpp"
#include "ident/not_a_number.hpp"
#include "ident/seed.hpp"
#include "mixture/criteria.hpp"
#include "mixture/heldout.hpp"

namespace modebank {

using Eigen::Index;

namespace {

struct FittedCandidate {
  GaussianMixture mixture;
  Candidate row;
};

/// The candidate numbers in increasing order, once each, without those above the number of points.
std::vector<Index> usable_components(const SelectionOptions& options, const WindowFits& fits, Index points) {
  std::vector<Index> components = options.components;
  std::sort(components.begin(), components.end());
  components.erase(std::unique(components.begin(), components.end()), components.end());
  if (components.empty() || components.front() < 1)
    throw std::invalid_argument("selection needs candidate numbers of components, each at least 1");
  if (components.front() > points) {
    const std::string fewer = points > 0 ? fmt::format("ask for at most {} components, or ", points) : "";
    throw DataError(fmt::format(
        "the fewest components asked for are {}, but {} of {} windows can be clustered: {}have more windows clustered "
        "(a prior for windows that are not excited, mixture.windows = all, shorter windows, more data)",
        components.front(), points, fits.count(), fewer));
  }
  components.erase(std::upper_bound(components.begin(), components.end(), points), components.end());
  return components;
}

FittedCandidate fit_candidate(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options,
                              Index components, std::uint64_t seed) {
  // The seed depends on the candidate's size, not on its place in the table: other candidates do not change it.
  const std::uint64_t own_seed = derive_seed(seed, "mixture", static_cast<std::uint64_t>(components));
  EmResult fit = fit_em(cloud.point_set(), components, options.em, own_seed);
  Candidate row;
  row.components = components;
  row.covariance = options.em.covariance;
  row.log_likelihood = fit.log_likelihood;
  row.parameters = fit.mixture.parameter_count();
  row.effective_samples = effective_samples(cloud, fits.length, fits.step);
  row.iterations = fit.iterations;
  row.converged = fit.converged;
  row.agreeing_restarts = fit.agreeing_restarts;
  fill_criteria(row, cloud.points.cols(), classification_entropy(fit.mixture, cloud.point_set()));
  row.heldout =
      options.criterion == Criterion::heldout ? heldout_score(cloud, components, options.em, own_seed) : not_a_number;
  return {std::move(fit.mixture), row};
}

[[noreturn]] void report_no_choice(const FeatureCloud& cloud, const SelectionOptions& options) {
  if (options.criterion == Criterion::heldout)
    throw DataError(fmt::format(
        "the held-out criterion needs windows of at least two runs, and more windows than components without each "
        "group of runs: there are {} windows in {} groups; use another criterion or more runs",
        cloud.points.cols(), heldout_groups(cloud)));
  throw DataError(fmt::format("no candidate mixture has a finite {} on {} windows", name_of(options.criterion),
                              cloud.points.cols()));
}

}  // namespace

MixtureResult select_mixture(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options,
                             std::uint64_t seed) {
  const std::vector<Index> components = usable_components(options, fits, cloud.points.cols());
  const Index count = static_cast<Index>(components.size());
  std::vector<FittedCandidate> fitted(count);
  // The largest candidates take longest and start first.
  tbb::parallel_for(
      tbb::blocked_range<Index>(0, count, 1),
      [&](const tbb::blocked_range<Index>& range) {
        for (Index i = range.begin(); i < range.end(); ++i)
          fitted[count - 1 - i] = fit_candidate(fits, cloud, options, components[count - 1 - i], seed);
      },
      tbb::simple_partitioner());
  MixtureResult result;
  for (const FittedCandidate& candidate : fitted) result.candidates.push_back(candidate.row);
  const Index best = best_candidate(result.candidates, options.criterion, cloud.points.cols());
  if (best < 0) report_no_choice(cloud, options);
  result.candidates[best].selected = true;
  result.mixture = std::move(fitted[best].mixture);
  result.feature_names = cloud.names;
  result.labels = most_probable(result.mixture, cloud, fits.count());
  result.responsibilities = WindowResponsibilities(result.mixture, cloud, fits.count());
  return result;
}

}  // namespace modebank
