#pragma once

#include <filesystem>

#include "io/table/format_options.hpp"

namespace modebank::fuzz {

/// Opens a log like `run` and reads all columns of its tables. `way` decides which columns are text, whether values may
/// be missing, and whether two columns are also imported.
void read_log(const std::filesystem::path& file, const FormatOptions& format, std::size_t way);

}  // namespace modebank::fuzz
