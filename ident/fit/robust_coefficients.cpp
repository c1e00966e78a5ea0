#include "ident/fit/robust_coefficients.hpp"

#include <algorithm>
#include <cmath>

#include "ident/fit/loss.hpp"
#include "ident/fit/minimise.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {
namespace {

using Eigen::VectorXd;

// as a share of the errors' root mean square; needed because more than half of the errors may be zero
constexpr double least_share_of_rms = 1e-3;
constexpr double least_normal_scale = 1e-150;  // the square of this value is still a normal floating-point number

}  // namespace

VectorXd robust_coefficients(const Transitions& transitions, const FitOptions& options) {
  const RobustLoss loss(options.loss, options.loss_scale);
  const Decomposition decomposition = decompose(transitions.regressors, excitation_tolerance);
  const double rms = std::sqrt(residuals(decomposition, transitions.increments).squaredNorm() /
                               static_cast<double>(transitions.count()));
  const double robust = robust_scale(transitions, decomposition)(0);
  VectorXd sigma(1);
  sigma << std::max({std::isfinite(robust) ? robust : 0.0, least_share_of_rms * rms, least_normal_scale});
  const WhitenedProblem problem = whiten(transitions, decomposition, sigma, nullptr);
  const Minimum minimum = minimise(problem, loss, options.max_iterations);
  return minimum.status == FitStatus::failed ? VectorXd() : problem.theta(minimum.z);
}

VectorXd robust_or_least_squares(const Transitions& transitions, const FitOptions& options) {
  VectorXd robust = robust_coefficients(transitions, options);
  if (robust.size() > 0 && robust.allFinite()) return robust;
  return solve(decompose(transitions.regressors, excitation_tolerance), transitions.increments);
}

}  // namespace modebank
