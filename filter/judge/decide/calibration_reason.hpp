#pragma once

#include "filter/judge/decide/diagnostics.hpp"

namespace modebank {

/// Numbers that a verdict is based on (rules: calibration.hpp). band: share inside the 95 % band. close: share near the
/// middle of the band. nis: mean NIS. few_samples: an interval is wider than the calibrated band.
enum class CalibrationReason { band, close, nis, few_samples };

CalibrationReason reason_of(const DiagnosticsRow& row);

/// Whether the band is too wide or too narrow. If so, the confidence interval of its share excludes the nominal share.
enum class BandWidth { as_stated, too_wide, too_narrow };
BandWidth width_of(double level, double coverage_lower, double coverage_upper);

/// Whether earlier errors predict a filter's errors: the errors are not white (Ljung & Box), and at least a hundredth
/// of their variance is predictable.
bool errors_follow_a_pattern(const DiagnosticsRow& row);

}  // namespace modebank
