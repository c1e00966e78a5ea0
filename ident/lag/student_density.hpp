#pragma once

#include <Eigen/Core>

namespace modebank {

/// Log density of each error under the Student t that fits them best: scale by maximum likelihood for 2, 4, 8, 30 and
/// 1000 degrees of freedom, of which the likeliest is taken. So outliers decide little. `weight`: N weights of the
/// errors, or empty; `floor`: what the scale may not fall below [unit of the errors], above 0. Errors must be finite.
Eigen::VectorXd fitted_student_log_density(const Eigen::VectorXd& errors, const Eigen::VectorXd& weight, double floor);

}  // namespace modebank
