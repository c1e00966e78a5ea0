#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace modebank {

/// Opens for binary reading. Throws ConfigurationError, naming path and reason, when the file cannot be read.
std::ifstream open_file(const std::filesystem::path& path);

/// All bytes of a file. Throws as open_file does.
std::string read_file(const std::filesystem::path& path);

}  // namespace modebank
