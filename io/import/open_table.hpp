#pragma once

#include <filesystem>
#include <memory>

#include "io/table/table_reader.hpp"

namespace modebank {

/// The reader for a file, chosen by the file's first bytes. Throws ConfigurationError if the file cannot be read. If
/// the format is known but has no reader, the message contains advice.
std::shared_ptr<const TableReader> open_table(const std::filesystem::path& path, const FormatOptions& options);

}  // namespace modebank
