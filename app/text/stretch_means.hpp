#pragma once

#include <Eigen/Core>

namespace modebank {

/// Means of each row of `rows` (K x N) over `count` parts of equal length, to draw a long series with few points. Part
/// i begins at column i N / count. Values that are not finite are ignored. A part with only such values gives NaN.
/// Returns at most N parts. Throws std::invalid_argument for count < 1.
Eigen::MatrixXd stretch_means(const Eigen::MatrixXd& rows, Eigen::Index count);

}  // namespace modebank
