#pragma once

#include <cstddef>
#include <string>

namespace modebank {

/// A mode that was removed from a bank, with the reason.
struct ScreenedMode {
  std::ptrdiff_t component = 0;  ///< index of its component in the mixture
  double weight = 0.0;           ///< share of the windows that belong to the mode
  double spectral_radius = 0.0;  ///< spectral radius of I + A
  std::string reason;            ///< "starved", "unstable" or "duplicate of mode 1"
};

}  // namespace modebank
