#pragma once

#include <Eigen/Core>
#include <array>

namespace modebank {

inline constexpr Eigen::Index noise_only_levels = 8;  // method: section 6, as the next
inline constexpr std::array<double, 4> noise_level_stays{0.7, 0.8, 0.9, 0.95};

/// levels x n, variances of one motion's residuals (N x n), one column per state: row j makes mode j's diagonal Q.
Eigen::MatrixXd noise_scales_per_state(const Eigen::MatrixXd& residuals, Eigen::Index levels);

}  // namespace modebank
