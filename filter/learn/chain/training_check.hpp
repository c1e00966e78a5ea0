#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"

/// Checks of the training runs before anything is fitted.
namespace modebank {

/// Throws DataError for a state that is constant in all training runs. Such a state contains no motion, and any filter
/// predicts it without error.
void refuse_constant_states(const Recording& recording);

/// Throws DataError for a given horizon (samples ahead) that is longer than the longest judged run. No sample could be
/// scored at this horizon. Judged runs are the held-out runs; without held-out runs, they are the training runs.
void refuse_unreached_horizons(const Recording& recording, const std::vector<Index>& horizons);

/// A message about regressors of the linear model that the training runs do not determine; empty if there is none.
std::string unidentifiable_effects(const Recording& recording, const LinearStructure& structure);
/// Effects of the fitted model that unidentifiable_effects lists.
std::string unidentifiable_effects(const Recording& recording, const FitOptions& options);

}  // namespace modebank
