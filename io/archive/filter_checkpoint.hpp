#pragma once

#include <filesystem>
#include <string>

#include "filter/step/bank_filter.hpp"
#include "io/files/output_file.hpp"

namespace modebank {

/// How check_output recognises a checkpoint, of any version.
FileForm checkpoint_form();

/// Writes a filter's state as JSON, with exact numbers. The file is complete or not written at all. `identity`:
/// identifies bank and settings of the filter. Throws DataError when the file cannot be written.
void save_checkpoint(const std::filesystem::path& path, const std::string& identity, const FilterSnapshot& snapshot);

/// Reads it back. Throws ConfigurationError when the file does not exist, DataError when it is not a checkpoint or has
/// another identity.
FilterSnapshot load_checkpoint(const std::filesystem::path& path, const std::string& identity);

}  // namespace modebank
