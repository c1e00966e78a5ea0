#pragma once

#include <filesystem>
#include <memory>

#include "io/recording/connections.hpp"

namespace modebank {

/// Opens a ROS 1 bag (format 2.0). Throws DataError for another format, an encrypted bag, or a bag without a complete
/// record.
std::unique_ptr<Container> open_bag(const std::filesystem::path& path);

}  // namespace modebank
