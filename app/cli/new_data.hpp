#pragma once

#include <string>

#include "app/cli/command_line.hpp"
#include "app/config/config.hpp"
#include "ident/data/streams.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank::app {

/// Whether the user typed this key.
bool given(const CommandLine& line, const std::string& key);

/// An archive's data section for files that it was not made from: their roles, places and labels are other ones, and
/// their measurements may end. Throws ConfigurationError where states came from files of their own and none are named.
void turn_to_new_files(const CommandLine& line, DataOptions& data);

/// How new data are brought to the archive's rate: which columns are averaged. Where the archive's lag was estimated,
/// sets data.lag_s to the pooled one, as held-out runs had it, taken in the middle of each step of `period_s`. A lag
/// that is stated stays.
AveragedColumns take_sampling(const CommandLine& line, const OpenArchive& archive, double period_s, DataOptions& data);

}  // namespace modebank::app
