#include "filter/judge/decide/calibration_reason.hpp"

#include <cmath>

namespace modebank {
namespace {

constexpr double coloured = 0.01;          // whiteness p
constexpr double noticeable_colour = 0.1;  // autocorrelation

CalibrationReason reason_of_overconfidence(const DiagnosticsRow& row) {
  const bool many = 1.0 - row.coverage_95 > many_outside && row.coverage_95_upper < 1.0 - true_outside;
  return many ? CalibrationReason::band : CalibrationReason::nis;
}

CalibrationReason reason_of_underconfidence(const DiagnosticsRow& row) {
  const double outside = 1.0 - row.coverage_95;
  if (outside < few_outside && row.coverage_95_lower > 1.0 - true_outside) return CalibrationReason::band;
  return outside < true_outside && row.too_close_lower > largest_close ? CalibrationReason::close
                                                                       : CalibrationReason::nis;
}

CalibrationReason reason_of_doubt(const DiagnosticsRow& row) {
  const Interval outside{1.0 - row.coverage_95_upper, 1.0 - row.coverage_95_lower};
  const bool unknown = row.samples == 0 || std::isnan(row.coverage_95) ||
                       says_nothing(outside, least_outside, largest_outside) ||
                       says_nothing({row.too_close_lower, row.too_close_upper}, least_close, largest_close);
  if (unknown) return CalibrationReason::few_samples;
  const double missed = 1.0 - row.coverage_95;
  return missed < least_outside || missed > largest_outside ? CalibrationReason::band : CalibrationReason::close;
}

}  // namespace

CalibrationReason reason_of(const DiagnosticsRow& row) {
  switch (row.verdict) {
    case Calibration::overconfident:
      return reason_of_overconfidence(row);
    case Calibration::underconfident:
      return reason_of_underconfidence(row);
    case Calibration::undecided:
      return reason_of_doubt(row);
    case Calibration::calibrated:
      break;
  }
  return CalibrationReason::band;
}

BandWidth width_of(double level, double coverage_lower, double coverage_upper) {
  if (coverage_lower > level) return BandWidth::too_wide;
  return coverage_upper < level ? BandWidth::too_narrow : BandWidth::as_stated;
}

bool errors_follow_a_pattern(const DiagnosticsRow& row) {
  return row.whiteness_p < coloured && std::abs(row.autocorrelation) > noticeable_colour;
}

}  // namespace modebank
