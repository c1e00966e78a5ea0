#include "app/text/calibration_text.hpp"

#include <fmt/format.h>

#include "app/text/judged_runs.hpp"
#include "filter/judge/decide/calibration_reason.hpp"

namespace modebank::app {
namespace {

std::string passing_words() {
  return fmt::format("{:g} to {:g} % passes", 100.0 * (1.0 - largest_outside), 100.0 * (1.0 - least_outside));
}

/// Text such as "mean NIS 1.21 (0.95 to 1.05 passes)".
std::string nis_words(const DiagnosticsRow& row) {
  return fmt::format("mean NIS {:.3g} ({:.3g} to {:.3g} passes)", row.nis_mean, row.nis_lower, row.nis_upper);
}

std::string close_words(const DiagnosticsRow& row) {
  return fmt::format("{:.1f} % lie as close to the prediction as 2.5 % should ({:g} to {:g} % passes)",
                     100.0 * row.too_close, 100.0 * least_close, 100.0 * largest_close);
}

std::string overconfidence_words(const DiagnosticsRow& row) {
  if (reason_of(row) == CalibrationReason::nis) return fmt::format("errors are larger than stated, {}", nis_words(row));
  return fmt::format("the band is too narrow ({})", passing_words());
}

std::string underconfidence_words(const DiagnosticsRow& row) {
  switch (reason_of(row)) {
    case CalibrationReason::nis:
      return fmt::format("errors are smaller than stated, {}", nis_words(row));
    case CalibrationReason::close:
      return close_words(row);
    default:
      return fmt::format("the band is too wide ({})", passing_words());
  }
}

std::string doubt_words(const DiagnosticsRow& row) {
  switch (reason_of(row)) {
    case CalibrationReason::few_samples:
      return fmt::format("too few independent samples to tell ({})", passing_words());
    case CalibrationReason::close:
      return close_words(row);
    default:
      return fmt::format("{}, and chance may explain the difference", passing_words());
  }
}

/// Text on another band, such as "50 %: 57.5 % (too wide)". It means that 57.5 % of the samples lie in the 50 % band,
/// so this band is too wide.
std::string other_band(double level, double coverage, double lower, double upper) {
  const BandWidth width = width_of(level, lower, upper);
  return fmt::format("{:g} %: {:.1f} %{}", 100.0 * level, 100.0 * coverage,
                     width == BandWidth::too_wide     ? " (too wide)"
                     : width == BandWidth::too_narrow ? " (too narrow)"
                                                      : "");
}

}  // namespace

std::string verdict_text(const DiagnosticsRow& row) {
  const auto with = [&](const std::string& why) { return fmt::format("{}, {}", name_of(row.verdict), why); };
  switch (row.verdict) {
    case Calibration::calibrated:
      return with(fmt::format("you can rely on it ({})", passing_words()));
    case Calibration::overconfident:
      return with(overconfidence_words(row));
    case Calibration::underconfident:
      return with(underconfidence_words(row));
    case Calibration::undecided:
      break;
  }
  return with(doubt_words(row));
}

std::string band_text(const DiagnosticsRow& row) {
  return fmt::format("{:.1f} % ({:.1f} to {:.1f}) of the {} samples lie in the 95 % band: {}; {}, {}, {}",
                     100 * row.coverage_95, 100 * row.coverage_95_lower, 100 * row.coverage_95_upper,
                     words_for(row.role), verdict_text(row),
                     other_band(0.50, row.coverage_50, row.coverage_50_lower, row.coverage_50_upper),
                     other_band(0.90, row.coverage_90, row.coverage_90_lower, row.coverage_90_upper),
                     other_band(0.99, row.coverage_99, row.coverage_99_lower, row.coverage_99_upper));
}

}  // namespace modebank::app
