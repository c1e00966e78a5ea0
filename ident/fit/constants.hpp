#pragma once

namespace modebank {

/// Constants that the scalar fit and the batch kernels share.

inline constexpr double huber_tuning = 1.345;  ///< in units of sigma; has 95 % efficiency at the normal distribution
                                               ///< (Holland & Welsch 1977)
inline constexpr double mad_to_sd = 1.4826;    ///< factor from the median absolute deviation of a Gaussian to its
                                               ///< standard deviation
inline constexpr double inlier_weight = 0.5;   ///< a sample counts as an inlier if it keeps at least this share of its
                                               ///< least-squares weight

/// Lower bound of 1 - leverage. If one sample alone determines a direction, its residual and 1 - leverage are both
/// zero.
inline constexpr double least_one_minus_leverage = 1e-6;
/// A fit has converged if the gradient, in orthonormal coordinates, is at most this share of |psi|.
inline constexpr double stationary_gradient = 1e-10;

}  // namespace modebank
