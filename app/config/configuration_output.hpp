#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace modebank::app {

/// Whether a text file consists of sections and keys, at least one of which is known.
bool is_configuration(const std::filesystem::path& path);

/// check_output for a configuration. An existing file may be edited by hand: only `force` replaces it.
void check_configuration_output(const std::string& option, const std::filesystem::path& path,
                                const std::vector<std::filesystem::path>& sources, bool force);

}  // namespace modebank::app
