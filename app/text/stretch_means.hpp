#pragma once

#include <Eigen/Core>

namespace modebank {

/// Means of each row of `rows` (K x N) over `count` stretches of equal length (stretch i begins at column i N / count),
/// for drawing a series in few places. What is not finite is left out; NaN where a stretch holds nothing else. At most
/// N stretches. Throws std::invalid_argument for count < 1.
Eigen::MatrixXd stretch_means(const Eigen::MatrixXd& rows, Eigen::Index count);

}  // namespace modebank
