#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "io/table/table_reader.hpp"

namespace modebank {

/// The reader for a file, chosen by the file's first bytes. Throws ConfigurationError if the file cannot be read. If
/// the format is known but has no reader, the message contains advice.
std::shared_ptr<const TableReader> open_table(const std::filesystem::path& path, const FormatOptions& options);
/// The reader for one file, or for a recording's parts in the order of writing. Also throws ConfigurationError for
/// several files that are not recordings.
std::shared_ptr<const TableReader> open_table(const std::vector<std::filesystem::path>& parts,
                                              const FormatOptions& options);

}  // namespace modebank
