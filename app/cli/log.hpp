#pragma once

#include <string>

namespace modebank::app {

/// Messages on standard error other than errors. The level selects which are printed: none, warnings, also progress, or
/// also every trial.
enum class Verbosity { quiet, warnings, normal, verbose };

/// Warnings are marked, and coloured on a terminal unless NO_COLOR is set (no-color.org).
void set_up_log(Verbosity verbosity);

/// Prefix of an error message, in colour under the same conditions as warnings.
std::string error_mark();

}  // namespace modebank::app
