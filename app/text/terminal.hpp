#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace modebank::app {

/// Properties of standard output.
struct Terminal {
  int width = 0;      ///< columns; 0: no limit (a file or a pipe, unless COLUMNS is set)
  bool utf8 = false;  ///< whether the locale's characters are UTF-8
};

/// COLUMNS overrides the terminal's own width, LC_ALL overrides LC_CTYPE, which overrides LANG.
Terminal standard_output();

/// Number of UTF-8 characters in a text; each counts as one column.
int columns_of(std::string_view text);

/// The first `columns` characters of a text.
std::string first_columns(std::string_view text, int columns);

/// The lines of a text, without their ends.
std::vector<std::string> lines_of(const std::string& text);

/// Breaks lines longer than `width` columns at spaces. Continuation lines are indented by the width of the line's label
/// ("windows   2250 of ..."). Words longer than a line stay whole. width 0: no change.
std::string wrapped(const std::string& text, int width);

}  // namespace modebank::app
