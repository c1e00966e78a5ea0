#include "filter/memberships.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace modebank {
namespace {

void check_sizes(const WindowFits& fits, const MixtureResult& mixture) {
  const Eigen::MatrixXd& gamma = mixture.responsibilities;
  if (gamma.rows() == mixture.mixture.components() && gamma.cols() == fits.count() &&
      mixture.labels.size() == fits.count())
    return;
  throw std::invalid_argument("memberships of " + std::to_string(gamma.cols()) + " windows in " +
                              std::to_string(gamma.rows()) + " components do not belong to " +
                              std::to_string(fits.count()) + " windows and " +
                              std::to_string(mixture.mixture.components()) + " components");
}

/// The clustered windows of every run of the recording, by increasing start.
std::vector<std::vector<Index>> clustered_windows_by_run(const WindowFits& fits, const MixtureResult& mixture) {
  Index runs = 0;
  for (const Window& window : fits.windows) runs = std::max(runs, window.run + 1);
  std::vector<std::vector<Index>> by_run(runs);
  for (Index i = 0; i < fits.count(); ++i)
    if (mixture.labels(i) >= 0) by_run[fits.windows[i].run].push_back(i);
  for (std::vector<Index>& windows : by_run)
    std::stable_sort(windows.begin(), windows.end(),
                     [&](Index a, Index b) { return fits.windows[a].start < fits.windows[b].start; });
  return by_run;
}

/// The clustered window nearest to a transition that none covers. `windows` is not empty.
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
Eigen::MatrixXd memberships_of_run(Index count, const std::vector<Index>& windows, const WindowFits& fits,
                                   const Eigen::MatrixXd& responsibilities) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(responsibilities.rows(), count);
  Eigen::VectorXd covering = Eigen::VectorXd::Zero(count);
  for (const Index i : windows) {
    const Index start = fits.windows[i].start;
    if (start < 0 || start + fits.length > count)
      throw std::invalid_argument("window " + std::to_string(i) + " does not lie inside its run of " +
                                  std::to_string(count) + " transitions");
    sum.middleCols(start, fits.length).colwise() += responsibilities.col(i);
    covering.segment(start, fits.length).array() += 1.0;
  }
  for (Index k = 0; k < count; ++k) {
    if (covering(k) > 0.0)
      sum.col(k) /= covering(k);
    else
      sum.col(k) = responsibilities.col(nearest_window(k, windows, fits));
  }
  return sum;
}

}  // namespace

Eigen::MatrixXd transition_memberships(const TrainingTransitions& transitions, const WindowFits& fits,
                                       const MixtureResult& mixture) {
  check_sizes(fits, mixture);
  const std::vector<std::vector<Index>> by_run = clustered_windows_by_run(fits, mixture);
  Eigen::MatrixXd memberships(transitions.count(), mixture.mixture.components());
  for (const RunRows& rows : transitions.runs) {
    auto run = memberships.middleRows(rows.first, rows.count);
    if (rows.run < std::ssize(by_run) && !by_run[rows.run].empty())
      run = memberships_of_run(rows.count, by_run[rows.run], fits, mixture.responsibilities).transpose();
    else
      run.rowwise() = mixture.mixture.weights.transpose();
  }
  // Rounding aside every row sums to one already; exactness makes the modes' weights add up to N.
  return transitions.usable.cwiseQuotient(memberships.rowwise().sum()).asDiagonal() * memberships;
}

}  // namespace modebank
