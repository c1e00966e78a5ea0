#pragma once

#include <cstddef>
#include <string>

namespace modebank {

/// Who solved the windows to what tolerance, and how a random sample of the batch solver's answers compares with those
/// of Ceres alone, run on to tolerances of 1e-16: both judged by the objective and its gradient.
struct WindowAudit {
  static constexpr double tolerance = 1e-9;  ///< relative difference in cost above which an answer is no minimum
  static constexpr double gradient_tolerance =
      1e-8;                           ///< the same of the gradient, in units of the residuals' influence
  std::ptrdiff_t batch = 0;           ///< windows that the batch solver solved
  std::ptrdiff_t ceres = 0;           ///< windows solved as `ceres_method` says; those of neither are unsolved
  std::string batch_method;           ///< in words; empty without a batch solver
  std::string ceres_method;           ///< in words
  std::ptrdiff_t checked = 0;         ///< windows of the batch solver solved again by Ceres alone
  double cost_difference = 0.0;       ///< largest relative difference in cost
  double gradient = 0.0;              ///< largest scaled gradient of the batch solver's answers
  double ceres_gradient = 0.0;        ///< largest scaled gradient of Ceres'
  double parameter_difference = 0.0;  ///< largest difference of a parameter in its standard errors: information only
  std::ptrdiff_t replaced = 0;  ///< checked windows whose cost or gradient was above tolerance: solved anew by Ceres
  std::ptrdiff_t lower = 0;     ///< checked windows whose cost was below Ceres' by more (losses with several minima)
};

}  // namespace modebank
