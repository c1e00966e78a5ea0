#pragma once

#include <cstddef>
#include <string>

namespace modebank {

/// A mode that was left out of a bank, and why.
struct ScreenedMode {
  std::ptrdiff_t component = 0;  ///< position in the mixture
  double weight = 0.0;           ///< share of the windows
  double spectral_radius = 0.0;  ///< of I + A
  std::string reason;            ///< "starved", "unstable" or "duplicate of mode 1"
};

}  // namespace modebank
