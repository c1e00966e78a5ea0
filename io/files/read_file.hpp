#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace modebank {

/// Opens for binary reading. Throws ConfigurationError, naming path and reason, when the file cannot be read.
std::ifstream open_file(const std::filesystem::path& path);

/// All bytes of a file. Throws as open_file does.
std::string read_file(const std::filesystem::path& path);

/// How many of `count` bytes at the offset of an open file there are, up to its end or `error`.
std::size_t read_at(int descriptor, char* to, std::size_t count, std::uintmax_t offset, std::error_code& error);

/// Throws DataError, naming it, where a device, a pipe or a folder (or a link to one) has the name of a file of ours:
/// reading one need never end. A path that is not there is none.
void refuse_special_file(const std::filesystem::path& path);

}  // namespace modebank
