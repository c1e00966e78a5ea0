#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"

/// What is looked at of the training runs before anything is fitted to them.
namespace modebank {

/// Throws DataError for a state that has one value in all of them: there is no motion to learn, and any filter predicts
/// it without error.
void refuse_constant_states(const Recording& recording);

/// Throws DataError for a stated horizon (samples ahead) that the longest of the judged runs, those held out or else
/// those trained on, does not reach: its errors would be those of no sample.
void refuse_unreached_horizons(const Recording& recording, const std::vector<Index>& horizons);

/// A line on regressors of the linear model that they leave open; empty: none.
std::string open_effects(const Recording& recording, const LinearStructure& structure);
/// The same of the model that is fitted.
std::string open_effects(const Recording& recording, const FitOptions& options);

}  // namespace modebank
