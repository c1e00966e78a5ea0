#pragma once

#include <cstddef>
#include <string>

namespace modebank {

/// Solvers and tolerances of the windows, and a check of the batch solver. The check compares a random sample of its
/// solutions with the solutions of Ceres alone, at tolerances of 1e-16. The objective and its gradient judge both
/// solutions.
struct WindowAudit {
  static constexpr double tolerance = 1e-9;  ///< relative cost difference above which a solution is not a minimum
  static constexpr double gradient_tolerance = 1e-8;  ///< scaled gradient above which a solution is not a minimum, in
                                                      ///< units of the residuals' influence
  std::ptrdiff_t batch = 0;                           ///< windows that the batch solver solved
  std::ptrdiff_t ceres = 0;           ///< windows that `ceres_method` solved; windows in neither count have no solution
  std::string batch_method;           ///< description of the batch solver; empty if it was not used
  std::string ceres_method;           ///< description
  std::ptrdiff_t checked = 0;         ///< windows of the batch solver that were solved again by Ceres alone, as a check
  double cost_difference = 0.0;       ///< largest relative difference in cost
  double gradient = 0.0;              ///< largest scaled gradient of the batch solver's solutions
  double ceres_gradient = 0.0;        ///< largest scaled gradient of Ceres' solutions
  double parameter_difference = 0.0;  ///< largest difference of a parameter, in standard errors; for information only
  std::ptrdiff_t replaced = 0;        ///< checked windows above a tolerance, whose results are replaced by those of
                                      ///< Ceres
  std::ptrdiff_t lower = 0;           ///< checked windows whose cost was below the cost of Ceres by more than the
                                      ///< tolerance (losses with several minima)
};

}  // namespace modebank
