#pragma once

#include <map>
#include <string>
#include <vector>

namespace modebank::app::report {

/// Colours "#rrggbb" of web/palette.json, which pages and figures share.
struct Palette {
  std::vector<std::string> modes;  ///< of the most used mode, the next, ...: as many as figures tell apart
  std::string outlier;
  std::map<std::string, std::string> filters;  ///< by their names in archives
};

Palette palette();

}  // namespace modebank::app::report
