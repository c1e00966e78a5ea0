#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank {

/// What is between the fields of a row. blank: any number of blanks and tabs.
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

/// Whether the first row names the columns; without, they are c1, c2, ...
enum class HeaderRow { automatic, yes, no };

template <>
struct EnumNames<HeaderRow> {
  static constexpr Names<3> values{"auto", "true", "false"};
};

/// What users say about files that say too little themselves: text files (automatic: it is found out) and recordings.
struct FormatOptions {
  Separator separator = Separator::automatic;
  DecimalMark decimal = DecimalMark::automatic;
  HeaderRow header = HeaderRow::automatic;
  std::vector<std::string> na{"NA", "N/A", "null", "-"};  ///< words for a missing value, beside empty fields and NaN
  std::size_t skip_rows = 0;                              ///< lines above the table
  bool skip_automatic = false;                            ///< lines above the table are found out in place of skip_rows
  std::string definitions = {};  ///< folder of .msg files, for types that a recording leaves undefined; empty: none
};

}  // namespace modebank
