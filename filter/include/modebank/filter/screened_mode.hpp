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

/// Modes that were drawn towards one motion, because the bank's predictions would have grown without limit.
struct Shrinking {
  std::ptrdiff_t modes = 0;  ///< that were drawn; 0: none
  double share = 0.0;        ///< of the way
  double growth = 0.0;       ///< of the second moment per step before: above 1
};

}  // namespace modebank
