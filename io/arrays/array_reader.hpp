#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "io/table/table_reader.hpp"

namespace modebank {

/// Whether HDF5 finds its signature in a file: at the front, or behind a user block of 512 bytes or any larger power of
/// two (MATLAB's v7.3 files have one).
bool is_hdf5(const std::filesystem::path& path);
/// Whether a file that is not HDF5 is MATLAB's: of version 6 or 7 by its first bytes, or by its name 4.
bool is_mat(const std::filesystem::path& path, std::string_view first);

/// Tables of a file of arrays: columns of equal length in one group (struct) form one, and go to the nearest group
/// above with columns of that length if they lack times and that has some. Throws as open_hdf5_columns does.
std::shared_ptr<const TableReader> open_hdf5_tables(const std::filesystem::path& path);
std::shared_ptr<const TableReader> open_mat_tables(const std::filesystem::path& path);

/// Whether a column of that name holds times: t, time, Time (s), stamp, timestamp, tout, ...
bool is_time_name(std::string_view name);

}  // namespace modebank
