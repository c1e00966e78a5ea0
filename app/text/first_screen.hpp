#pragma once

#include <string>

#include "app/text/screen_facts.hpp"

/// What `run` ends with, and `show` begins with: the answer on one screen of a terminal. summary_text has the rest.
namespace modebank::app {

inline constexpr int screen_lines = 24, screen_columns = 100;

/// The screen as text: what was read, what was found, the modes, how far to trust the band, how good the mean is,
/// warnings, what to do next and where all of it is. At most screen_lines lines of screen_columns columns, but for the
/// line of a longer `file`; a terminal of less `width` has narrower ones. `program`: how commands to be typed next call
/// it.
std::string first_screen(const Archive& archive, const Settings& settings, const std::string& file, int width = 0,
                         const std::string& program = "modebank");

}  // namespace modebank::app
