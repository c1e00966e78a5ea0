#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace modebank::app {

/// What standard output can show.
struct Terminal {
  int width = 0;      ///< columns; 0: no limit (a file or a pipe, unless COLUMNS says otherwise)
  bool utf8 = false;  ///< whether the locale's characters are UTF-8
};

/// The environment's COLUMNS wins over the terminal's own width, LC_ALL over LC_CTYPE over LANG.
Terminal standard_output();

/// Characters of UTF-8 text, each taken as one column.
int columns_of(std::string_view text);

/// The first `columns` characters.
std::string first_columns(std::string_view text, int columns);

/// What stands between the line ends.
std::vector<std::string> lines_of(const std::string& text);

/// Breaks lines longer than `width` columns at spaces; continuation lines are indented as far as the label of their
/// line reaches ("windows   2250 of ..."). Words longer than a line stay whole. width 0: the text as it is.
std::string wrapped(const std::string& text, int width);

}  // namespace modebank::app
