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

/// Record of the shrinkage of modes towards one motion. Modes shrink if the bank's predictions would otherwise grow
/// without limit.
struct Shrinking {
  std::ptrdiff_t modes = 0;  ///< number of shrunk modes
  double share = 0.0;        ///< shrinkage: share of a mode's distance to the common motion that was removed
  double growth = 0.0;       ///< growth factor of the second moment per step before the shrinkage, above 1
};

}  // namespace modebank
