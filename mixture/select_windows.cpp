#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "ident/error.hpp"
#include "mixture/select.hpp"
#include "mixture/straddling.hpp"

namespace modebank {

using Eigen::Index;

namespace {

constexpr int trimming_rounds = 4;

void check_enough(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options) {
  const auto fewest = std::min_element(options.components.begin(), options.components.end());
  const Index points = cloud.points.cols();
  if (fewest == options.components.end() || *fewest <= points) return;
  const std::string fewer = points > 0 ? fmt::format("ask for at most {} components, or ", points) : "";
  throw DataError(fmt::format(
      "the fewest components asked for are {}, but {} of {} windows can be clustered: {}have more windows clustered (a "
      "prior for windows that are not excited, mixture.windows = all, shorter windows, more data)",
      *fewest, points, fits.count(), fewer));
}

Selection select_cloud(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options,
                       std::uint64_t seed) {
  return select(cloud.point_set(), {effective_samples(cloud, fits.length, fits.step), cloud.runs}, options, seed);
}

FeatureCloud without(const FeatureCloud& cloud, const std::vector<bool>& flagged) {
  std::vector<Index> kept;
  for (Index i = 0; i < cloud.points.cols(); ++i)
    if (!flagged[static_cast<std::size_t>(cloud.windows[static_cast<std::size_t>(i)])]) kept.push_back(i);
  return subset(cloud, kept);
}

MixtureResult with_memberships(const FeatureCloud& cloud, Index windows, Selection selection) {
  MixtureResult result;
  result.mixture = std::move(selection.mixture);
  result.feature_names = cloud.names;
  result.candidates = std::move(selection.candidates);
  result.weights_standard_error = std::move(selection.standard_error.weights);
  result.means_standard_error = std::move(selection.standard_error.means);
  result.labels = most_probable(result.mixture, cloud, windows);
  result.responsibilities = WindowResponsibilities(result.mixture, cloud, windows);
  return result;
}

}  // namespace

MixtureResult select_mixture(const WindowFits& fits, const FeatureCloud& cloud, const SelectionOptions& options,
                             std::uint64_t seed) {
  check_enough(fits, cloud, options);
  if (options.straddling != StraddlingWindows::trim)
    return with_memberships(cloud, fits.count(), select_cloud(fits, cloud, options, seed));
  SelectionOptions brief = options;
  brief.bootstrap = 0;
  brief.heldout = HeldoutChoice::never;
  FeatureCloud kept = cloud;
  std::vector<bool> flagged(static_cast<std::size_t>(fits.count()), false);
  for (int round = 0; round < trimming_rounds; ++round) {
    const GaussianMixture mixture = select_cloud(fits, kept, brief, seed).mixture;
    const std::vector<bool> now = windows_at_switches(fits, most_probable(mixture, cloud, fits.count()));
    if (now == flagged) break;
    flagged = now;
    kept = without(cloud, flagged);
  }
  return with_memberships(kept, fits.count(), select_cloud(fits, kept, options, seed));
}

}  // namespace modebank
