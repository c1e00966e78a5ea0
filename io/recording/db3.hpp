#pragma once

#include <filesystem>
#include <memory>

#include "io/recording/connections.hpp"

namespace modebank {

/// Opens a rosbag2 recording in SQLite for reading only. The database's schema is not trusted. A journal beside the
/// file is not applied. Throws DataError if the database has other tables.
std::unique_ptr<Container> open_db3(const std::filesystem::path& path);

}  // namespace modebank
