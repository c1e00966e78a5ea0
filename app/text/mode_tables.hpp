#pragma once

#include <string>
#include <vector>

#include "app/text/mode_families.hpp"
#include "io/archive/archive.hpp"

/// The bank's modes as tables. The first screen and the page show families; `show` also shows single modes.
namespace modebank::app {

/// The most used families as text, one row each: modes, use, stay, slowest time constant, gains.
struct ModeTable {
  struct Row {
    std::vector<Index> modes;  ///< most used first
    std::string title;         ///< of the family
    std::vector<std::string> cells;
  };
  std::vector<std::string> headings;
  std::vector<Row> rows;
  Index families = 0;       ///< of the bank
  Index others = 0;         ///< families that have no row
  double others_use = 0.0;  ///< sum of their use
  std::string gain_unit;    ///< common unit of all gains; empty if they have none or several
};
/// At most `rows` rows; the last one may hold the other families. 0: all families that told_of counts.
ModeTable mode_table(const Archive& archive, Index rows = 0);

/// The same as text: a heading and at most `rows` lines of `width` columns. Gains without room are left out.
struct ShortModes {
  std::string text;
  Index gains_left_out = 0;
};
ShortModes short_modes(const Archive& archive, Index rows, int width);
/// All families and all modes with all numbers, for `show`. width 0: no limit.
std::string modes_in_words(const Archive& archive, int width = 0);

}  // namespace modebank::app
