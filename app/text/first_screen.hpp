#pragma once

#include <string>

#include "app/text/screen_facts.hpp"

/// The text at the end of `run` and at the beginning of `show`: the answer on one screen of a terminal. summary_text
/// prints all other results.
namespace modebank::app {

inline constexpr int screen_lines = 24, screen_columns = 100;

/// The screen as text: data, finding, modes, reliability of the band, errors of the mean, warnings and
/// files. It has at most screen_lines lines. Their width is at most screen_columns columns, or `width` if that is less.
/// Only the line with a long `file` may be wider. `program`: name of the program in commands to type.
std::string first_screen(const Archive& archive, const Settings& settings, const std::string& file, int width = 0,
                         const std::string& program = "modebank");

}  // namespace modebank::app
