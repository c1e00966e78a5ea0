#pragma once

#include <string>

namespace modebank::app {

/// A path as text for a configuration file. It is in double quotes only if it could not be read back without quotes.
std::string path_text(const std::string& path);

}  // namespace modebank::app
