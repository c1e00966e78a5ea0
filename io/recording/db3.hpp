#pragma once

#include <filesystem>
#include <memory>

#include "io/recording/connections.hpp"

namespace modebank {

/// Opens a rosbag2 recording in SQLite for reading only, and does not trust its schema. A journal beside the file is
/// not applied. Throws DataError for a database with other tables.
std::unique_ptr<Container> open_db3(const std::filesystem::path& path);

}  // namespace modebank
