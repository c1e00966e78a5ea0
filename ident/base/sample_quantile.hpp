#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace modebank {

/// Quantile by linear interpolation between order statistics at position (N - 1) p, as in numpy and R's type 7.
/// `sorted` holds N >= 1 values in increasing order; p lies in [0, 1].
inline double sample_quantile(std::span<const double> sorted, double p) {
  const double position = static_cast<double>(sorted.size() - 1) * p;
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], position - static_cast<double>(below));
}

}  // namespace modebank
