#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace modebank::app {

/// Whether a text file consists of sections and keys, with at least one known key, or has a line [data].
bool is_configuration(const std::filesystem::path& path);

/// Same as check_output, for a configuration. Users may have edited an existing file, so only `force` replaces it.
void check_configuration_output(const std::string& option, const std::filesystem::path& path,
                                const std::vector<std::filesystem::path>& sources, bool force);

}  // namespace modebank::app
