#pragma once

#include <Eigen/Core>

namespace modebank {

/// Sum over k of later(k) earlier(k - lag) of two series of N values about their means, the numerator of their
/// correlation at that lag; 0 from N on.
template <class Later, class Earlier>
double lagged_product(const Later& later, const Earlier& earlier, Eigen::Index lag) {
  const Eigen::Index pairs = later.size() - lag;
  return pairs > 0 ? later.tail(pairs).matrix().dot(earlier.head(pairs).matrix()) : 0.0;
}

}  // namespace modebank
