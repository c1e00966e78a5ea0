#pragma once

namespace modebank {

/// Numbers that the scalar fit and the batch kernels must agree on.

inline constexpr double huber_tuning = 1.345;  ///< of sigma: 95 % efficiency at the normal (Holland & Welsch 1977)
inline constexpr double mad_to_sd = 1.4826;    ///< median absolute deviation of a Gaussian to its standard deviation
inline constexpr double inlier_weight = 0.5;   ///< an inlier keeps at least this share of its least-squares weight
/// 1 - leverage is kept above this: a sample that determines a direction alone has residual and 1 - leverage both zero.
inline constexpr double least_one_minus_leverage = 1e-6;
/// A fit has ended where the gradient, in orthonormal coordinates, is at most this share of |psi|.
inline constexpr double stationary_gradient = 1e-10;

}  // namespace modebank
