#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace modebank::app {

/// Whether a file of text has sections and keys alone, one of which is known.
bool is_configuration(const std::filesystem::path& path);

/// check_output for a configuration. One that is there is somebody's work: it is replaced with `force` alone.
void check_configuration_output(const std::string& option, const std::filesystem::path& path,
                                const std::vector<std::filesystem::path>& sources, bool force);

}  // namespace modebank::app
