#pragma once

#include <string>
#include <vector>

namespace modebank::app::report {

/// Colours "#rrggbb" of web/palette.json, which pages and figures share.
struct Palette {
  std::vector<std::string> modes;  ///< of mode 0, 1, ...; from where they come again they are darker, then lighter
  std::string bank, baseline, noise_only, outlier;
};

/// For `modes` modes, by the rule of modeColour in web/plots.js.
Palette palette(int modes);

}  // namespace modebank::app::report
