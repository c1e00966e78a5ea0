#pragma once

#include <string>

namespace modebank::app {

/// A path as a configuration file states it: plain if it reads back the same, else in double quotes.
std::string path_text(const std::string& path);

}  // namespace modebank::app
