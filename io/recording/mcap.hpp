#pragma once

#include <filesystem>
#include <memory>

#include "io/recording/connections.hpp"

namespace modebank {

/// Opens an MCAP file, chunked or not, with or without a summary. Throws DataError for another format and for a file
/// without a complete record.
std::unique_ptr<Container> open_mcap(const std::filesystem::path& path);

}  // namespace modebank
