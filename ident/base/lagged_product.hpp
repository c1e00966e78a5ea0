#pragma once

#include <Eigen/Core>

namespace modebank {

/// Numerator of the correlation of two series of N values at one lag: the sum over k of later(k) earlier(k - lag). The
/// mean of each series is subtracted first. 0 for lag >= N.
template <class Later, class Earlier>
double lagged_product(const Later& later, const Earlier& earlier, Eigen::Index lag) {
  const Eigen::Index pairs = later.size() - lag;
  return pairs > 0 ? later.tail(pairs).matrix().dot(earlier.head(pairs).matrix()) : 0.0;
}

}  // namespace modebank
