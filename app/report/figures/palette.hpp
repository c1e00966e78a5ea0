#pragma once

#include <map>
#include <string>
#include <vector>

namespace modebank::app::report {

/// Colours "#rrggbb" of web/palette.json, which pages and figures share.
struct Palette {
  std::vector<std::string> modes;  ///< of mode 0, 1, ...; from where they come again they are darker, then lighter
  std::string outlier;
  std::map<std::string, std::string> filters;  ///< by their names in archives
};

/// For `modes` modes, by the rule of modeColour in web/plots.js.
Palette palette(int modes);

}  // namespace modebank::app::report
