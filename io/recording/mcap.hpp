#pragma once

#include <filesystem>
#include <memory>

#include "io/recording/connections.hpp"

namespace modebank {

/// Opens an MCAP file, with or without chunks and summary. Throws DataError for another format, and for a file without
/// a complete record.
std::unique_ptr<Container> open_mcap(const std::filesystem::path& path);

}  // namespace modebank
