#pragma once

#include <string>
#include <vector>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// How one linear model answers to a step of one input: "T per heater: 63 % of .802 +- .003 K/W after 63.0 +- .3 s,
/// within 5 % after 181 s". Where a pole lies within two errors of 1, the words say that it integrates or settles
/// slower than some time; a steady value that is uncertain by more than a third is a limit, "within +-0.9 K/W in the
/// end". One text per pair of state and input, those that move most first (gain times the input's standard deviation).
/// Empty without a response.
std::vector<std::string> response_words(const Bank& single, const Recording& recording, const std::string& unit);

}  // namespace modebank::app
