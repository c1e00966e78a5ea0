#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace modebank {

/// One object of an archive as JSON: a group becomes {"attributes": {...}, "members": {name: {kind, shape, units}}}, a
/// dataset
/// {"attributes": ..., "shape": ..., "value": nested arrays or, for tables, an array of row objects, whose "columns"
/// are listed in the file's order}. NaN becomes null. Throws ConfigurationError when the path is not in the file
/// (naming the members of the deepest group that exists) and DataError as read_archive does.
nlohmann::json inspect(const std::filesystem::path& archive, const std::string& path);

}  // namespace modebank
