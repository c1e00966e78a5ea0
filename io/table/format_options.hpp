#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank {

/// Separator of the fields in a row. blank: any number of blanks and tabs.
enum class Separator { automatic, comma, semicolon, tab, pipe, blank };

template <>
struct EnumNames<Separator> {
  static constexpr Names<6> values{"auto", "comma", "semicolon", "tab", "pipe", "blank"};
};

enum class DecimalMark { automatic, point, comma };

template <>
struct EnumNames<DecimalMark> {
  static constexpr Names<3> values{"auto", "point", "comma"};
};

/// Whether the first row names the columns; otherwise they are c1, c2, ...
enum class HeaderRow { automatic, yes, no };

template <>
struct EnumNames<HeaderRow> {
  static constexpr Names<3> values{"auto", "true", "false"};
};

/// Options on formats that files do not state: of text files (automatic: it is found) and of recordings.
struct FormatOptions {
  Separator separator = Separator::automatic;
  DecimalMark decimal = DecimalMark::automatic;
  HeaderRow header = HeaderRow::automatic;
  std::vector<std::string> na{"NA", "N/A", "null", "-"};  ///< words for a missing value, beside empty fields and NaN
  std::size_t skip_rows = 0;                              ///< lines above the table
  bool skip_automatic = false;                            ///< the number of title lines is found, and skip_rows ignored
  std::string definitions = {};  ///< folder of .msg files for types that a recording does not define; empty: none
};

}  // namespace modebank
