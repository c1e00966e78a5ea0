#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// Model-based agglomeration (Fraley 1998, SIAM J. Sci. Comput. 20, 270-281, unconstrained covariances): starting from
/// every point on its own, the two clusters are merged again and again that cost the classification likelihood least. A
/// cluster of n points with scatter W costs n log(|W / n| + tr(W / n) + trace / F), where trace / F is the mean
/// variance of a feature over all points: so also small clusters have a finite cost.
struct Agglomeration {
  struct Merge {
    int kept = 0, absorbed = 0;  ///< clusters are named after their first point
  };
  std::vector<Merge> merges;  ///< n - 1, in order

  /// Clusters 0..K-1 of the n points when K are left, numbered by their first points.
  std::vector<int> labels(Eigen::Index components) const;
};

/// `points` F x n in units of equal importance; time and memory grow with n^2, so take some hundred. Equal costs are
/// decided by the points' order.
Agglomeration agglomerate(const Eigen::MatrixXd& points);

}  // namespace modebank
