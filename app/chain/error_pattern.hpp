#pragma once

#include "filter/judge/decide/finding.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// Whether past errors and inputs predict the bank's errors on its training runs.
/// - Least squares regress each state's z (RunScores) on z and inputs of up to twelve samples before. A fifth of the
///   runs is left out each time; with fewer than six runs, a fifth of their parts.
/// - The gain is the log density of the residuals minus that of z, each under its best Student t.
/// - Modes leave no such pattern, however fast they switch. Missing lags and delays do.
/// - The result is unknown after a search for lags, for models without lags, for scattered steps, for a bank from
///   another archive, and for fewer than 50 samples per regressor.
ErrorPattern error_pattern(const Archive& archive, const FilterEvaluation& bank);

}  // namespace modebank
