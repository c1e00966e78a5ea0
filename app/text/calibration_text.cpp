#include "app/text/calibration_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/text/judged_runs.hpp"

namespace modebank::app {
namespace {

std::string passing_words() {
  return fmt::format("{:g} to {:g} % passes", 100.0 * (1.0 - largest_outside), 100.0 * (1.0 - least_outside));
}

/// The number that a verdict is based on, and what passes.
std::string reason_words(const DiagnosticsRow& row) {
  const bool undecided = row.verdict == Calibration::undecided, over = row.verdict == Calibration::overconfident;
  const auto signals = static_cast<double>(row.state_rmse.size());
  switch (row.reason) {
    case CalibrationReason::few_samples:
      return fmt::format("too few independent samples to tell ({})", passing_words());
    case CalibrationReason::close:
      return fmt::format("{:.1f} % lie as close to the prediction as 2.5 % should ({:g} to {:g} % passes)",
                         100.0 * row.too_close, 100.0 * least_close, 100.0 * largest_close);
    case CalibrationReason::nis:
      return fmt::format("{}mean NIS {:.3g} ({:.3g} to {:.3g} passes)",
                         undecided ? "" : fmt::format("errors are {} than stated, ", over ? "larger" : "smaller"),
                         row.nis_mean, (undecided ? least_nis : 1.0 - nis_tolerance) * signals,
                         (undecided ? most_nis : 1.0 + nis_tolerance) * signals);
    case CalibrationReason::pattern:
      return fmt::format("errors resemble the ones before (lag-1 correlations within {:g} pass)", largest_correlation);
    case CalibrationReason::none:
    case CalibrationReason::band:
      break;
  }
  return undecided ? fmt::format("{}, and chance may explain the difference", passing_words())
                   : fmt::format("the band is too {} ({})", over ? "narrow" : "wide", passing_words());
}

}  // namespace

std::string verdict_text(const DiagnosticsRow& row) {
  if (row.verdict == Calibration::calibrated) return fmt::format("calibrated ({})", passing_words());
  return fmt::format("{}, {}", name_of(row.verdict), reason_words(row));
}

std::string band_text(const DiagnosticsRow& row, const std::vector<ErrorAhead>& errors) {
  std::string ahead;
  for (const ErrorAhead& error : errors)
    if (error.steps > 1 && !std::isnan(error.coverage_95))
      ahead += fmt::format(", {:.1f} % {} ahead", 100 * error.coverage_95, error.steps);
  return fmt::format("{:.1f} % ({:.1f} to {:.1f}) of the {} samples lie in the 95 % band one step ahead{}: {}",
                     100 * row.coverage_95, 100 * row.coverage_95_lower, 100 * row.coverage_95_upper,
                     words_for(row.role), ahead, verdict_text(row));
}

}  // namespace modebank::app
