#pragma once

#include <string>

#include "app/cli/command_line.hpp"
#include "app/config/config.hpp"
#include "ident/data/streams.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank::app {

/// Whether the key is on the command line.
bool given(const CommandLine& line, const std::string& key);

/// Prepares an archive's data section for other files, which have other roles, places and labels; their measurements
/// may end early. Throws ConfigurationError where the archive's states came from separate files and none are given.
void turn_to_new_files(const CommandLine& line, DataOptions& data);

/// How new data are brought to the archive's rate: the columns to average. If the archive's lag was estimated, sets
/// data.lag_s to the pooled one, as for held-out runs, taken in the middle of each step of `period_s`. A stated lag
/// stays.
AveragedColumns take_sampling(const CommandLine& line, const OpenArchive& archive, double period_s, DataOptions& data);

}  // namespace modebank::app
