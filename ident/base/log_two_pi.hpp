#pragma once

namespace modebank {

inline constexpr double log_two_pi = 1.8378770664093454836;  ///< ln(2 pi), the constant of Gaussian log densities

}  // namespace modebank
