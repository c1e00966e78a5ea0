#pragma once

#include <filesystem>
#include <vector>

#include "app/cli/command_line.hpp"
#include "app/init/file_sets.hpp"

namespace modebank::app {

/// The three files that `run LOG` writes.
struct LogOutputs {
  std::filesystem::path configuration, archive, page;

  std::vector<std::filesystem::path> all() const { return {configuration, archive, page}; }
};

/// The names come from archive.output if it is set, else from the logs. In the second case the files are in the current
/// folder.
LogOutputs log_outputs(const CommandLine& line, const std::vector<FileSet>& sets);

/// Throws ConfigurationError if
/// - a file exists and --force was not given,
/// - a file cannot be written,
/// - a file is one of the logs,
/// - or an existing file has another form.
void check_log_outputs(const CommandLine& line, const LogOutputs& outputs, const std::vector<FileSet>& sets);

}  // namespace modebank::app
