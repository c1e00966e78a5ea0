#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "io/table/table_reader.hpp"

namespace modebank {

/// Whether a file has HDF5's signature: at its start, or behind a user block of 512 bytes or a larger power of two.
/// MATLAB's v7.3 files have such a block.
bool is_hdf5(const std::filesystem::path& path);
/// Whether a file is a MATLAB file other than HDF5: version 6 or 7 by its first bytes, version 4 by its name.
bool is_mat(const std::filesystem::path& path, std::string_view first);

/// Tables of a file of arrays. Columns of equal length in one group (struct) form a table. Without times, they join the
/// nearest enclosing group that has times and columns of that length. Throws as open_hdf5_columns does.
std::shared_ptr<const TableReader> open_hdf5_tables(const std::filesystem::path& path);
std::shared_ptr<const TableReader> open_mat_tables(const std::filesystem::path& path);

/// Whether a column has a usual name of times: t, time, Time (s), stamp, timestamp, tout, ...
bool is_time_name(std::string_view name);

}  // namespace modebank
