#pragma once

#include <Eigen/Core>

namespace modebank {

/// Means of each row of `rows` (K x N) over `count` parts of equal length (part i begins at column i N / count), to
/// draw a long series in few places. Ignores values that are not finite; NaN for parts without others. Returns at most
/// N parts. Throws std::invalid_argument for count < 1.
Eigen::MatrixXd stretch_means(const Eigen::MatrixXd& rows, Eigen::Index count);

}  // namespace modebank
