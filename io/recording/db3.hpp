#pragma once

#include <filesystem>
#include <memory>

#include "io/recording/connections.hpp"

namespace modebank {

/// Opens a recording of rosbag2 in SQLite: read only, as it lies (a journal beside it is not applied), its schema not
/// trusted. Throws DataError for a database of other tables.
std::unique_ptr<Container> open_db3(const std::filesystem::path& path);

}  // namespace modebank
