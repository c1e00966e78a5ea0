#pragma once

#include "filter/judge/finding.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// Tests whether past errors and inputs predict the bank's errors on its training runs.
/// - Least squares regress each state's z (RunScores) on z and the inputs of up to twelve earlier samples.
/// - Each fit leaves out a fifth of the runs, or a fifth of the parts if there are fewer than six runs.
/// - The gain is the log density of the residuals minus the log density of z, each under its best Student t
///   distribution.
/// - Modes do not make errors predictable, however fast they switch. Missing lags and delays do.
/// - The result is unknown after a search for lags, for models without lags, for scattered steps and for a bank from
///   another archive. It is also unknown for fewer than 50 samples per regressor.
ErrorPattern error_pattern(const Archive& archive, const FilterEvaluation& bank);

}  // namespace modebank
