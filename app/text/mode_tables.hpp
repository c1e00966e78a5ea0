#pragma once

#include <string>
#include <vector>

#include "app/text/motions.hpp"
#include "io/archive/archive.hpp"

/// The bank's modes as tables. The first screen and the page show motions. `show` also shows single modes.
namespace modebank::app {

/// The most used motions as text. Each row has modes, use, stay, slowest time constant and gains.
struct ModeTable {
  struct Row {
    std::vector<Index> modes;  ///< the motion's modes, the most used mode first
    std::vector<std::string> cells;
  };
  std::vector<std::string> headings;
  std::vector<Row> rows;
  Index others = 0;         ///< number of motions without a row of their own
  double others_use = 0.0;  ///< sum of the use of these motions
  std::string gain_unit;    ///< unit of all gains; empty if the gains have no unit or different units
};
/// The table with at most `rows` rows. Its last row may stand for all other motions. 0: all motions that `told_of`
/// counts. `unit`: that of times, here and below.
ModeTable mode_table(const Archive& archive, Index rows = 0, const std::string& unit = "s");

/// The table as text: a heading and at most `rows` lines of `width` columns. Gains that do not fit are omitted.
struct ShortModes {
  std::string text;
  Index gains_left_out = 0;
};
ShortModes short_modes(const Archive& archive, Index rows, int width, const std::string& unit = "s");
/// All motions and all modes with all numbers, for `show`. `width`: 0 means no limit.
std::string modes_in_words(const Archive& archive, int width = 0, const std::string& unit = "s");

}  // namespace modebank::app
