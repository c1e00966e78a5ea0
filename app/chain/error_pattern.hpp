#pragma once

#include "filter/judge/decide/finding.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// Whether past errors and inputs predict the bank's errors on its training runs. Least squares regress each output's z
/// (RunScores) on z and inputs of up to twelve samples before, with a fifth of the runs (below six: of stretches of
/// them) left out. Compared are log densities of what is left and of z, each under the Student t that fits it. Modes
/// leave no such pattern, however fast they switch; lags and delays that the model lacks do. Unknown where lags were
/// searched for, for models that have none, where steps scatter, for a bank that was learned elsewhere, and for fewer
/// than 50 samples per regressor.
ErrorPattern error_pattern(const Archive& archive, const FilterEvaluation& bank);

}  // namespace modebank
