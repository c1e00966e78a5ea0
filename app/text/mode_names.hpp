#pragma once

#include <string>
#include <vector>

#include "filter/learn/chain/progress.hpp"
#include "io/archive/archive.hpp"

/// What people call the bank's modes: as bank.mode_names says, else by the label that they are mostly found at.
namespace modebank {

/// The label that holds at least 60 % of a mode's samples; empty without.
std::string label_of_mode(const Archive& archive, Index mode);

/// One name per mode of the bank, empty where it has none; nothing where no mode has one. `given` names the first
/// modes. Where these are not as many as there are modes, that is said and costs nobody his run: how many modes there
/// are is known after it alone.
std::vector<std::string> mode_names_of(const Archive& archive, const std::vector<std::string>& given,
                                       const Progress& progress);

/// A name of a user as one line, without what a terminal would obey.
std::string one_line(std::string name);
/// The stored name, on one line; empty where there is none.
std::string name_of_mode(const std::vector<std::string>& names, Index mode);
/// In a column of modes: "0", or "0 ice".
std::string mode_cell(const std::vector<std::string>& names, Index mode);
/// Anywhere else: "mode 0", or "mode 0: ice".
std::string mode_title(const std::vector<std::string>& names, Index mode);

}  // namespace modebank
