#include "app/text/warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "mixture/criteria.hpp"

namespace modebank::app {

void WindowCounts::add(const WindowFits& fits) {
  for (const int value : fits.status) ++status[static_cast<std::size_t>(value)];
}

std::string window_warning(const WindowCounts& counts) {
  const Index failed = counts.of(FitStatus::failed);
  if (failed == 0) return "";
  return fmt::format(
      "{} of {} windows have no finite fit and are left out; their samples may have values too large to square; see "
      "`modebank check`",
      failed, counts.total());
}

std::string refinement_warning(MeasuredFit fit) {
  if (fit == MeasuredFit::iteration_limit)
    return "the fit with measurement noise stopped after 100 iterations without convergence";
  if (fit == MeasuredFit::stalled) return "the fit with measurement noise stalled without convergence";
  return "";
}

std::string stability_warning(const Bank& bank) {
  double least = std::numeric_limits<double>::infinity();
  for (const Mode& mode : bank.modes) least = std::min(least, spectral_radius(mode.model));
  if (bank.modes.empty() || least <= 1.0 + spectral_radius_slack) return "";
  return fmt::format(
      "no mode of the bank is stable (spectral radius {:.4g}), so predictions many samples ahead grow; leave out of "
      "data.state what drifts or stays (a position, a held speed)",
      least);
}

std::string unscored_warning(const Archive& archive, double least_share) {
  if (!archive.bank || !archive.recording) return "";
  const Index start = archive.bank->structure.first_transition() + 1;
  std::map<std::string, Index> scored;
  for (const SummaryRow& row : archive.summary)
    if (row.filter == "bank") scored[row.run] = row.samples;
  Index all = 0, lost = 0, most = 0;
  std::string worst;
  for (const Trajectory& run : archive.recording->runs) {
    const auto row = scored.find(run.run);
    if (row == scored.end()) continue;
    const Index measured = run.state.array().isFinite().colwise().any().count();
    const Index unscored = std::max<Index>(0, measured - start - row->second);
    all += measured;
    lost += unscored;
    if (unscored > most) most = unscored, worst = run.run;
  }
  if (lost == 0 || static_cast<double>(lost) < least_share * static_cast<double>(all)) return "";
  return fmt::format(
      "{} of {} measured samples have no score, most of them in run {}; the filter needs {} complete samples in a row "
      "at its start and after a long gap",
      lost, all, worst, archive.bank->structure.state_lags);
}

constexpr double many_unscored = 0.05;  // a smaller fraction causes no warning

std::vector<std::string> archive_warnings(const Archive& archive) {
  std::vector<std::string> warnings;
  const auto add = [&](const std::string& text) {
    if (!text.empty()) warnings.push_back(text);
  };
  if (archive.windows) {
    WindowCounts counts;
    counts.add(*archive.windows);
    add(window_warning(counts));
  }
  if (archive.mixture_makes_bank())
    for (const std::string& text : selection_warnings(archive.mixture->candidates)) add(text);
  if (archive.bank) {
    add(refinement_warning(archive.measured_fit));
    add(stability_warning(*archive.bank));
  }
  add(unscored_warning(archive, many_unscored));
  return warnings;
}

}  // namespace modebank::app
