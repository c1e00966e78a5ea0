#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace modebank {

/// Walks through a MATLAB file of version 4, 6 or 7 before libmatio sees it, which believes every size that the file
/// declares. Throws DataError where a part is said to be larger than what is there, or has no form that these files
/// have. Returns the classes of the variables that are objects (iddata, table, ...), of which libmatio gives neither
/// class nor content.
std::map<std::string, std::string> check_mat(const std::filesystem::path& path);

}  // namespace modebank
