#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank {

/// Separator of the fields in a row. `blank` means any number of blanks and tabs.
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

/// Whether the first row names the columns. Without names they are c1, c2, ...
enum class HeaderRow { automatic, yes, no };

template <>
struct EnumNames<HeaderRow> {
  static constexpr Names<3> values{"auto", "true", "false"};
};

/// Options that describe a format where files do not: for text files (`automatic`: found from the file) and for
/// recordings.
struct FormatOptions {
  Separator separator = Separator::automatic;
  DecimalMark decimal = DecimalMark::automatic;
  HeaderRow header = HeaderRow::automatic;
  std::vector<std::string> na{"NA", "N/A", "null", "-"};  ///< words that mean a missing value, in addition to empty
                                                          ///< fields and NaN
  std::size_t skip_rows = 0;                              ///< number of lines above the table
  bool skip_automatic = false;                            ///< true: the number of title lines is found from the file,
                                                          ///< and skip_rows is ignored
  std::string definitions = {};  ///< folder of .msg files for types that a recording does not define; empty: no folder
};

}  // namespace modebank
