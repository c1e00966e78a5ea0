#pragma once

#include <Eigen/Core>
#include <vector>

#include "mixture/point_set.hpp"

namespace modebank {

/// A copy of some of the points, with all that is known of them.
struct PointPart {
  Eigen::MatrixXd points;
  Eigen::VectorXd weights;
  Eigen::MatrixXd covariances;

  PointPart(const PointSet& all, const std::vector<Eigen::Index>& positions)
      : points(all.points(Eigen::all, positions)) {
    if (all.weights.size() > 0) weights = all.weights(positions);
    if (all.has_errors()) covariances = all.covariances(Eigen::all, positions);
  }
  PointSet set() const { return PointSet(points, weights, covariances); }
};

}  // namespace modebank
