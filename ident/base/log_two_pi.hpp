#pragma once

namespace modebank {

inline constexpr double log_two_pi = 1.8378770664093454836;  ///< of Gaussian densities: ln(2 pi)

}  // namespace modebank
