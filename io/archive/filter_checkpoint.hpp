#pragma once

#include <filesystem>
#include <string>

#include "filter/step/bank_filter.hpp"
#include "io/files/output_file.hpp"

namespace modebank {

/// A checkpoint of any version, as check_output recognises one.
FileForm checkpoint_form();

/// Writes what a filter remembers as JSON, complete or not at all, every number as it is. `identity`: what bank and
/// settings it is a filter of. Throws DataError when the file cannot be written.
void save_checkpoint(const std::filesystem::path& path, const std::string& identity, const FilterSnapshot& snapshot);

/// Reads it back. Throws ConfigurationError when there is no such file, DataError when it is not a checkpoint or one of
/// another identity.
FilterSnapshot load_checkpoint(const std::filesystem::path& path, const std::string& identity);

}  // namespace modebank
