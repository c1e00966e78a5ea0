#pragma once

#include <filesystem>
#include <memory>

#include "io/recording/connections.hpp"

namespace modebank {

/// Opens an MCAP file, chunked or not, with or without a summary. Throws DataError for what is none or holds nothing
/// whole.
std::unique_ptr<Container> open_mcap(const std::filesystem::path& path);

}  // namespace modebank
