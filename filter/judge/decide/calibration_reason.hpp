#pragma once

#include "filter/judge/decide/diagnostics.hpp"

namespace modebank {

/// Which numbers of a row its verdict rests on (calibration.hpp has the rules). band: the share in the 95 % band.
/// close: the share next to its middle. nis: the mean NIS. few_samples: an interval is wider than what counts as
/// calibrated.
enum class CalibrationReason { band, close, nis, few_samples };

CalibrationReason reason_of(const DiagnosticsRow& row);

/// A band whose interval leaves out its nominal share.
enum class BandWidth { as_stated, too_wide, too_narrow };
BandWidth width_of(double level, double coverage_lower, double coverage_upper);

/// Whether a filter's errors could be predicted from those before: they are not white (Ljung & Box), and a hundredth of
/// their variance or more follows a pattern.
bool errors_follow_a_pattern(const DiagnosticsRow& row);

}  // namespace modebank
