#pragma once

#include <filesystem>
#include <string>

#include "filter/step/bank_filter.hpp"
#include "io/files/output_file.hpp"

namespace modebank {

/// Tells check_output how to recognise a checkpoint of any version.
FileForm checkpoint_form();

/// Writes a filter's state as JSON with exact numbers. The file is written completely or not at all. `identity`
/// identifies the filter's bank and settings. Throws DataError if the file cannot be written.
void save_checkpoint(const std::filesystem::path& path, const std::string& identity, const FilterSnapshot& snapshot);

/// Reads a checkpoint. Throws ConfigurationError if the file does not exist, and DataError if it is not a checkpoint or
/// has another identity.
FilterSnapshot load_checkpoint(const std::filesystem::path& path, const std::string& identity);

}  // namespace modebank
