#pragma once

#include <string>

#include "app/cli/command_line.hpp"
#include "app/config/config.hpp"
#include "ident/data/streams.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank::app {

/// Whether the command line sets the key.
bool given(const CommandLine& line, const std::string& key);

/// Prepares an archive's data section for other files. These have other roles, folders and labels, and their
/// measurements may end early. Throws ConfigurationError if the archive's states came from separate files but none are
/// given.
void turn_to_new_files(const CommandLine& line, DataOptions& data);

/// Prepares the sampling of new data at the archive's rate and returns the columns to average. If the archive's lag was
/// estimated, data.lag_s becomes the pooled lag, as for held-out runs. It then refers to the middle of each step of
/// `period_s`. A stated lag stays as it is.
AveragedColumns take_sampling(const CommandLine& line, const OpenArchive& archive, double period_s, DataOptions& data);

}  // namespace modebank::app
