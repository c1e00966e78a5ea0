#pragma once

#include <string>
#include <vector>

#include "filter/learn/chain/chain.hpp"
#include "io/archive/archive.hpp"

/// Names of the bank's modes. They come from bank.mode_names, else from the most frequent label among the mode's
/// samples.
namespace modebank {

/// The label of at least 60 % of a mode's samples; empty if there is none.
std::string label_of_mode(const Archive& archive, Index mode);

/// One name per mode of the bank; empty for a mode without a name. Returns an empty list if no mode has a name. `given`
/// names the first modes. If the number of given names is wrong, this only causes a warning, because users cannot know
/// the number of modes before the run.
std::vector<std::string> mode_names_of(const Archive& archive, const std::vector<std::string>& given, const Tell& tell);

/// A user's name as one line. It contains no control characters of a terminal.
std::string one_line(std::string name);
/// The stored name of a mode on one line; empty if there is none.
std::string name_of_mode(const std::vector<std::string>& names, Index mode);
/// Text for a column of modes: "0" or "0 ice".
std::string mode_cell(const std::vector<std::string>& names, Index mode);
/// Text for all other places: "mode 0" or "mode 0: ice".
std::string mode_title(const std::vector<std::string>& names, Index mode);

}  // namespace modebank
