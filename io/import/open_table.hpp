#pragma once

#include <filesystem>
#include <memory>

#include "io/table/table_reader.hpp"

namespace modebank {

/// The reader of a file's format, which its first bytes tell. Throws ConfigurationError when the file cannot be read
/// and for formats that are known but not read here, saying what to do instead.
std::shared_ptr<const TableReader> open_table(const std::filesystem::path& path, const FormatOptions& options);

}  // namespace modebank
