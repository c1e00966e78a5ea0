#include "app/text/window_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>

#include "app/text/mode_words.hpp"
#include "app/text/number_text.hpp"
#include "ident/model/parameter_labels.hpp"

namespace modebank::app {

std::string sensor_noise_words(const Archive& archive) {
  constexpr double harmless = 0.1;  // largest share of R in Q
  if (!archive.windows || !archive.bank) return "";
  const Bank& bank = *archive.bank;
  const Eigen::MatrixXd& Q = bank.modes[static_cast<std::size_t>(used_modes(archive).front().mode)].Q;
  const Eigen::VectorXd noise = (bank.C * Q * bank.C.transpose()).diagonal();
  if ((bank.R.diagonal().array() <= harmless * noise.array()).all()) return "";
  return std::string("the windows' parameters are biased by sensor noise; the bank's are ") +
         (archive.mixture_makes_bank() ? "their means" : "not");
}

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
  if (const std::string warning = window_warning(counts); !warning.empty()) text += "warning   " + warning + "\n";
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
