#pragma once

#include <Eigen/Core>

namespace modebank {

/// Log density of each error under the best-fitting Student t, so that outliers have little influence. For each of 2,
/// 4, 8, 30 and 1000 degrees of freedom, the scale of maximum likelihood is computed. The most likely of these five
/// distributions is used. `floor`: smallest scale [unit of the errors], above 0. Errors must be finite.
Eigen::VectorXd fitted_student_log_density(const Eigen::VectorXd& errors, double floor);

}  // namespace modebank
