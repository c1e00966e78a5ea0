#pragma once

#include <string>
#include <vector>

#include "app/text/mode_families.hpp"
#include "io/archive/archive.hpp"

/// The bank's modes as tables: on the first screen and the page by family, in `show` one by one, too.
namespace modebank::app {

/// The most used families in words, a row each: modes, use, stay, slowest time constant, gains.
struct ModeTable {
  struct Row {
    std::vector<Index> modes;  ///< most used first
    std::string title;         ///< of the family
    std::vector<std::string> cells;
  };
  std::vector<std::string> headings;
  std::vector<Row> rows;
  Index families = 0;       ///< of the bank
  Index others = 0;         ///< families that are not among the rows
  double others_use = 0.0;  ///< of all of them together
  std::string gain_unit;    ///< that all gains have; empty where none or several are known
};
/// At most `rows` rows, that of the others being one of them; 0: as many as are told.
ModeTable mode_table(const Archive& archive, Index rows = 0);

/// The same as a text of at most `rows` lines below its heading, `width` columns wide: gains for which there is no room
/// are left out.
struct ShortModes {
  std::string text;
  Index gains_left_out = 0;
};
ShortModes short_modes(const Archive& archive, Index rows, int width);
/// All families and all modes with all of it, for `show`. 0: no limit.
std::string modes_in_words(const Archive& archive, int width = 0);

}  // namespace modebank::app
