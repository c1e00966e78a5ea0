#include "filter/learn/from_mixture/memberships.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "ident/fit/fit_windows.hpp"
#include "mixture/features.hpp"

namespace modebank {
namespace {

/// F x M features of the windows that have features, in the order of `clustered`.
Eigen::MatrixXd features_of_all(const WindowFits& fits, const std::vector<Channel>& states,
                                const FeatureCloud& clustered) {
  const FeatureCloud all =
      in_features(make_features(fits, FeatureSet::parameters_and_noise, WindowChoice::all, states), clustered.names);
  Eigen::MatrixXd features = Eigen::MatrixXd::Constant(all.points.rows(), fits.count(), not_a_number);
  features(Eigen::all, all.windows) = all.points;
  return features;
}

}  // namespace

MixtureResult cluster_windows(const Recording& recording, const WindowFits& fits, const FitOptions& window,
                              const ClusterOptions& options, std::uint64_t seed) {
  std::optional<WindowFits> one_lag;
  if (clusters_one_lag(fits, options.features)) one_lag = fit_one_lag(recording, fits, window);
  const WindowFits& seen = one_lag ? *one_lag : fits;
  const FeatureCloud cloud = make_features(seen, recording.states, options);
  MixtureResult result = select_mixture(seen, cloud, options.selection, seed, nullptr,
                                        assigned_features(seen, recording.states, options, cloud.names));
  const std::vector<std::string> first = seen.parameter_names();
  if (one_lag || cloud.names.size() < first.size() || !std::equal(first.begin(), first.end(), cloud.names.begin()))
    result.features = features_of_all(seen, recording.states, cloud);
  return result;
}

namespace {

void check_sizes(const WindowFits& fits, const MixtureResult& mixture) {
  const WindowResponsibilities& gamma = mixture.responsibilities;
  if (gamma.components() == mixture.mixture.components() && gamma.windows() == fits.count() &&
      mixture.labels.size() == fits.count())
    return;
  throw std::invalid_argument("memberships of " + std::to_string(gamma.windows()) + " windows in " +
                              std::to_string(gamma.components()) + " components do not belong to " +
                              std::to_string(fits.count()) + " windows and " +
                              std::to_string(mixture.mixture.components()) + " components");
}

/// A run's clustered windows by increasing start, with their responsibilities. Includes windows that are noise.
struct RunWindows {
  std::vector<Index> windows;
  Index first = 0;                   ///< index of the window in the first column
  Eigen::MatrixXd responsibilities;  ///< K x number of windows, from the run's first to its last
};

RunWindows windows_of_run(const std::vector<Index>& all, const WindowFits& fits, const MixtureResult& mixture) {
  RunWindows run;
  if (all.empty()) return run;
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  run.first = *least;
  run.responsibilities = mixture.responsibilities.block(run.first, *most - *least + 1);
  for (const Index i : all)
    if (!std::isnan(run.responsibilities(0, i - run.first))) run.windows.push_back(i);
  std::stable_sort(run.windows.begin(), run.windows.end(),
                   [&](Index a, Index b) { return fits.windows[a].start < fits.windows[b].start; });
  return run;
}

/// The windows of every run of the recording.
std::vector<std::vector<Index>> windows_by_run(const WindowFits& fits) {
  Index runs = 0;
  for (const Window& window : fits.windows) runs = std::max(runs, window.run + 1);
  std::vector<std::vector<Index>> by_run(runs);
  for (Index i = 0; i < fits.count(); ++i) by_run[fits.windows[i].run].push_back(i);
  return by_run;
}

/// The clustered window nearest to a transition that no window covers. `windows` must contain at least one window.
Index nearest_window(Index transition, const std::vector<Index>& windows, const WindowFits& fits) {
  const auto after = std::partition_point(windows.begin(), windows.end(),
                                          [&](Index i) { return fits.windows[i].start <= transition; });
  if (after == windows.begin()) return *after;
  const auto before = std::prev(after);
  if (after == windows.end()) return *before;
  const Index gap_before = transition - (fits.windows[*before].start + fits.length - 1);
  const Index gap_after = fits.windows[*after].start - transition;
  return gap_before <= gap_after ? *before : *after;
}

/// Mean responsibility of the covering windows for the transitions of one run, K x count.
Eigen::MatrixXd memberships_of_run(Index count, const RunWindows& run, const WindowFits& fits) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(run.responsibilities.rows(), count);
  Eigen::VectorXd covering = Eigen::VectorXd::Zero(count);
  for (const Index i : run.windows) {
    const Index start = fits.windows[i].start;
    if (start < 0 || start + fits.length > count)
      throw std::invalid_argument("window " + std::to_string(i) + " does not lie inside its run of " +
                                  std::to_string(count) + " transitions");
    sum.middleCols(start, fits.length).colwise() += run.responsibilities.col(i - run.first);
    covering.segment(start, fits.length).array() += 1.0;
  }
  for (Index k = 0; k < count; ++k) {
    if (covering(k) > 0.0)
      sum.col(k) /= covering(k);
    else
      sum.col(k) = run.responsibilities.col(nearest_window(k, run.windows, fits) - run.first);
  }
  return sum;
}

}  // namespace

Eigen::MatrixXd transition_memberships(const TrainingTransitions& transitions, const WindowFits& fits,
                                       const MixtureResult& mixture) {
  check_sizes(fits, mixture);
  const std::vector<std::vector<Index>> by_run = windows_by_run(fits);
  Eigen::MatrixXd memberships(transitions.count(), mixture.mixture.components());
  for (const RunRows& rows : transitions.runs) {
    auto of_run = memberships.middleRows(rows.first, rows.count);
    const RunWindows run =
        rows.run < std::ssize(by_run) ? windows_of_run(by_run[rows.run], fits, mixture) : RunWindows();
    if (!run.windows.empty())
      of_run = memberships_of_run(rows.count, run, fits).transpose();
    else
      of_run.rowwise() = mixture.mixture.weights.transpose();
  }
  if (mixture.mixture.noise.present()) return transitions.usable.asDiagonal() * memberships;
  // Every row already sums to one, except for rounding. With exact sums, the weights of the modes add up to N.
  return transitions.usable.cwiseQuotient(memberships.rowwise().sum()).asDiagonal() * memberships;
}

}  // namespace modebank
