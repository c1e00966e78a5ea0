#pragma once

#include <string>

namespace modebank::app {

/// Messages on standard error beside errors: none, warnings, progress as well, or all that was tried, too.
enum class Verbosity { quiet, warnings, normal, verbose };

/// Warnings are marked, and coloured on a terminal unless NO_COLOR is set (no-color.org).
void set_up_log(Verbosity verbosity);

/// What an error's message begins with, coloured under the same conditions.
std::string error_mark();

}  // namespace modebank::app
