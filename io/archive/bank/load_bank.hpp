#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "filter/step/bank.hpp"
#include "filter/step/drifting.hpp"

namespace modebank {

/// One bank of an archive: "bank" or the competitor "baseline", "noise_only" or "one_motion". Nothing else of the file
/// is decoded. Throws as read_archive does, and DataError when the archive holds no such bank.
Bank load_bank(const std::filesystem::path& path, const std::string& which = "bank");

/// Its drifting competitor. Throws as load_bank does.
DriftingModel load_drifting(const std::filesystem::path& path);

class GroupReader;
/// Runs `body` on the root of an archive whose hash is right; messages name the path. Throws as read_archive does.
void read_root(const std::filesystem::path& path, const std::function<void(GroupReader&)>& body);

/// The resolved configuration an archive was made with.
std::string load_configuration(const std::filesystem::path& path);

/// The hash of the data it was made from.
std::string load_data_hash(const std::filesystem::path& path);

/// The archive's SHA-256, as its user block states it: tells archives apart.
std::string archive_digest(const std::filesystem::path& path);

}  // namespace modebank
