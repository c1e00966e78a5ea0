#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Where one linear model was learned: "means: T 31.9 degC, heater 20.1 W; T 19.98 degC at zero input". The state at
/// zero input is left out where it would be extrapolated: where zero lies outside the range of an input, where a model
/// has no constant or may not settle. Empty without training runs, and for more than four columns.
std::string operating_words(const Bank& single, const Recording& recording);

/// Where the single linear model is one of differences: "the level of T wanders or differs by run (sd 5 K): something
/// that acts is not logged". The standard deviation is that of the states less the response to the inputs and less the
/// sensor noise, without the beginnings of runs, which are not at rest. Else empty.
std::string level_doubt(const Archive& archive);

}  // namespace modebank::app
