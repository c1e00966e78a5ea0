#pragma once

#include <cstddef>
#include <string>

namespace modebank {

/// A mode that was left out of a bank, with the reason.
struct ScreenedMode {
  std::ptrdiff_t component = 0;  ///< index in the mixture
  double weight = 0.0;           ///< share of the windows
  double spectral_radius = 0.0;  ///< spectral radius of I + A
  std::string reason;            ///< "starved", "unstable" or "duplicate of mode 1"
};

/// Record of shrinking modes towards one motion, done because the bank's predictions would have grown without limit.
struct Shrinking {
  std::ptrdiff_t modes = 0;  ///< number of shrunk modes; 0: none
  double share = 0.0;        ///< share of the distance to the common motion
  double growth = 0.0;       ///< growth of the second moment per step before shrinking: above 1
};

}  // namespace modebank
