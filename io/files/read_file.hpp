#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace modebank {

/// Opens a file for binary reading. Throws ConfigurationError with path and reason if the file cannot be read.
std::ifstream open_file(const std::filesystem::path& path);

/// All bytes of a file. Throws the same exceptions as open_file.
std::string read_file(const std::filesystem::path& path);

/// Reads up to `count` bytes at an offset of an open file. Returns the number of bytes read. It is smaller than `count`
/// at the end of the file or on `error`.
std::size_t read_at(int descriptor, char* to, std::size_t count, std::uintmax_t offset, std::error_code& error);

/// Throws DataError with the path for a device, a pipe, a folder, or a link to one of these, because reading may never
/// end. A missing path is accepted.
void refuse_special_file(const std::filesystem::path& path);

}  // namespace modebank
