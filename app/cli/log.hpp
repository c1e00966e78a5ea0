#pragma once

#include <string>

namespace modebank::app {

/// What comes to standard error beside errors: nothing, progress and warnings, or all that was tried, too.
enum class Verbosity { quiet, normal, verbose };

/// Warnings are marked, and coloured on a terminal unless NO_COLOR is set (no-color.org).
void set_up_log(Verbosity verbosity);

/// What an error's message begins with, coloured under the same conditions.
std::string error_mark();

}  // namespace modebank::app
