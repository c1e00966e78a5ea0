#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "io/table/table_reader.hpp"

namespace modebank {

/// Whether a file has HDF5's signature at its start or after a user block. The block has 512 bytes or a larger power of
/// two. MATLAB's v7.3 files have such a block.
bool is_hdf5(const std::filesystem::path& path);
/// Whether a file is a MATLAB file that is not HDF5. Versions 6 and 7 are recognised by the first bytes, version 4 by
/// the file name.
bool is_mat(const std::filesystem::path& path, std::string_view first);

/// The tables of a file of arrays. Columns of equal length in one group (struct) form a table. A table without times
/// joins the nearest enclosing group that has times and columns of the same length. Throws the same exceptions as
/// open_hdf5_columns.
std::shared_ptr<const TableReader> open_hdf5_tables(const std::filesystem::path& path);
std::shared_ptr<const TableReader> open_mat_tables(const std::filesystem::path& path);

/// Whether a column's name is usual for times: t, time, Time (s), stamp, timestamp, tout, ...
bool is_time_name(std::string_view name);

}  // namespace modebank
