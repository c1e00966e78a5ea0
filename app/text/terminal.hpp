#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace modebank::app {

/// Properties of standard output.
struct Terminal {
  int width = 0;  ///< number of columns; 0 means no limit, for a file or a pipe without COLUMNS
};

/// COLUMNS overrides the terminal's own width.
Terminal standard_output();

/// Number of UTF-8 characters in a text. Each character counts as one column.
int columns_of(std::string_view text);

/// The first `columns` characters of a text.
std::string first_columns(std::string_view text, int columns);

/// The lines of a text without their line breaks.
std::vector<std::string> lines_of(const std::string& text);

/// Breaks lines longer than `width` columns at spaces. Continuation lines are indented by the width of the line's label
/// ("windows 2250 of ..."). Words that are longer than a line are not broken. `width`: 0 means no change.
std::string wrapped(const std::string& text, int width);

}  // namespace modebank::app
