#include "app/text/window_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>

#include "app/text/mode_words.hpp"
#include "app/text/number_text.hpp"
#include "ident/model/parameter_labels.hpp"

namespace modebank::app {
namespace {

/// The solvers of the windows, and the batch solver's audit. Empty if the archive has no audit.
std::string audit_text(const WindowAudit& audit) {
  if (audit.ceres_method.empty()) return "";
  std::string text = "solved    ";
  if (audit.batch > 0) text += fmt::format("{} windows by {} (batch solver)", audit.batch, audit.batch_method);
  if (audit.batch > 0 && audit.ceres > 0) text += ", ";
  if (audit.ceres > 0) text += fmt::format("{} windows by {}", audit.ceres, audit.ceres_method);
  if (audit.batch + audit.ceres == 0) text += "no window";
  text += "\n";
  if (audit.checked == 0) return text;
  text +=
      fmt::format("audit     {} of the batch solver's windows against Ceres alone: cost differs by {:.1e} relative, ",
                  audit.checked, audit.cost_difference);
  text += fmt::format("gradient {:.1e} (Ceres {:.1e}); parameters by {:.1e} standard errors", audit.gradient,
                      audit.ceres_gradient, audit.parameter_difference);
  if (audit.lower > 0) text += fmt::format("; {} in a lower minimum than that of Ceres", audit.lower);
  return text + "\n";
}

}  // namespace

std::vector<std::string> window_labels(const Archive& archive) {
  if (!archive.windows) return {};
  const Recording none;
  const Recording& recording = archive.recording ? *archive.recording : none;
  return parameter_labels(*archive.windows, names_of(recording.states), names_of(recording.inputs));
}

std::vector<std::string> feature_labels(const Archive& archive, std::vector<std::string> names) {
  if (!archive.windows) return names;
  const WindowFits& fits = *archive.windows;
  const Recording none;
  const Recording& recording = archive.recording ? *archive.recording : none;
  std::map<std::string, std::string> label_of;
  const auto add = [&](const std::vector<std::string>& parameters, const std::vector<std::string>& labels) {
    for (std::size_t i = 0; i < parameters.size(); ++i) label_of.emplace(parameters[i], labels[i]);
  };
  add(fits.parameter_names(), window_labels(archive));
  const LinearStructure one_lag = fits.structure.with_one_lag();
  if (fits.model_parameters.empty())
    add(one_lag.parameter_names(), parameter_labels(one_lag, names_of(recording.states), names_of(recording.inputs)));
  for (std::string& name : names)
    if (const auto found = label_of.find(name); found != label_of.end()) name = found->second;
  return names;
}

std::string features_origin(const Archive& archive) {
  const bool others = archive.mixture && archive.mixture->features.size() > 0;
  return others && archive.windows && archive.windows->structure.has_several_lags()
             ? " of one-lag fits of the same windows"
             : "";
}

std::string windows_text(const WindowFits& fits, const WindowCounts& counts, const std::vector<std::string>& labels) {
  std::string text =
      fmt::format("windows   {} of {} steps: {} converged, {} rank deficient, {} at the iteration limit, {} failed\n",
                  counts.total(), fits.length, counts.of(FitStatus::converged), counts.of(FitStatus::rank_deficient),
                  counts.of(FitStatus::iteration_limit), counts.of(FitStatus::failed));
  text += audit_text(fits.audit);
  for (const Warning& warning : window_warnings(fits, counts)) text += "warning   " + warning.text + "\n";
  text += "global    ";
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto k = static_cast<Index>(i);
    const double variance = fits.global.covariance(k, k);
    text += i == 0 ? "" : ", ";
    text += std::isnan(variance)
                ? labels[i] + " " + not_identifiable
                : fmt::format("{} = {:.4g} +- {:.2g}", labels[i], fits.global.theta(k), std::sqrt(variance));
  }
  return text + fmt::format("; residual variance {:.4g}\n", fmt::join(fits.global.noise_variance(), " "));
}

}  // namespace modebank::app
