#pragma once

#include <filesystem>
#include <string>

#include "filter/step/bank.hpp"

namespace modebank {

/// One bank of an archive: "bank", "baseline" or "noise_only". Nothing else of the file is decoded. Throws as
/// read_archive does, and DataError when the archive holds no such bank.
Bank load_bank(const std::filesystem::path& path, const std::string& which = "bank");

/// The resolved configuration an archive was made with.
std::string load_configuration(const std::filesystem::path& path);

/// The archive's SHA-256, as its user block states it: tells archives apart.
std::string archive_digest(const std::filesystem::path& path);

}  // namespace modebank
