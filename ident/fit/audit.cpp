#include "ident/fit/audit.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "ident/base/seed.hpp"
#include "ident/fit/minimise.hpp"

namespace modebank {

namespace {

constexpr Index least_audit = 200;
constexpr Index audit_share = 1000;       ///< one window in this many is audited
constexpr double negligible_cost = 1e-9;  ///< per sample

/// The data of a window and its objective.
struct Objective {
  const LinearWindows::WindowData& data;
  const WhitenedProblem& problem;
  const RobustLoss& loss;
  const ParameterPrior* prior;

  /// Residuals are computed from the transitions, not from the whitened problem. So the audit does not depend on the
  /// basis.
  RobustTerms terms(const Eigen::VectorXd& theta) const {
    const Transitions& t = data.transitions;
    const Index q = t.regressors.cols(), n = t.increments.cols(), L = t.count();
    const Eigen::Map<const Eigen::MatrixXd> coefficients(theta.data(), q, n);
    const Eigen::MatrixXd r =
        (t.increments - t.regressors * coefficients) * data.scale.sigma.cwiseInverse().asDiagonal();
    Eigen::VectorXd residual(problem.b.size());
    residual.head(L * n) = r.transpose().reshaped();
    if (prior) residual.tail(theta.size()) = (prior->mean - theta).cwiseQuotient(prior->sd);
    return evaluate_at(problem, loss, std::move(residual));
  }
};

double relative_cost_above(double cost, double ceres_cost, Index samples) {
  return (cost - ceres_cost) / std::max(ceres_cost, negligible_cost * static_cast<double>(samples));
}

}  // namespace

std::vector<Index> audited_windows(Index M, std::uint64_t seed) {
  const Index strata = std::min(M, std::max(least_audit, M / audit_share));
  std::mt19937_64 generator = make_generator(seed, "window_audit");
  std::vector<Index> windows;
  for (Index s = 0; s < strata; ++s) {
    const Index begin = s * M / strata, size = (s + 1) * M / strata - begin;
    windows.push_back(begin + static_cast<Index>(generator() % static_cast<std::uint64_t>(size)));
  }
  return windows;
}

AuditedWindow audit_window(const LinearWindows& windows, const Window& window, const ParameterPrior* prior,
                           const LocalModel& fit) {
  AuditedWindow result;
  const auto data = windows.load(window);
  if (!data) return result;
  const RobustLoss& loss = windows.estimator().loss;
  const WhitenedProblem problem = whiten(data->transitions, data->decomposition, data->scale.sigma, prior);
  const Minimum ceres = minimise_by_ceres_alone(problem, loss);
  if (ceres.status == FitStatus::failed) return result;
  const Eigen::VectorXd ceres_theta = problem.theta(ceres.z);
  const Objective objective{*data, problem, loss, prior};
  const RobustTerms ours = objective.terms(fit.theta), theirs = objective.terms(ceres_theta);
  result.compared = true;
  result.cost = relative_cost_above(2.0 * half_cost(problem, loss, ours), 2.0 * half_cost(problem, loss, theirs),
                                    problem.samples);
  result.gradient = scaled_gradient(problem, ours);
  result.ceres_gradient = scaled_gradient(problem, theirs);
  const Eigen::ArrayXd difference = (fit.theta - ceres_theta).cwiseAbs();
  result.parameter = (difference / fit.covariance.diagonal().array().sqrt()).maxCoeff();
  return result;
}

bool add_to_audit(const AuditedWindow& window, WindowAudit& audit) {
  if (!window.compared) return false;
  ++audit.checked;
  audit.cost_difference = std::max(audit.cost_difference, std::abs(window.cost));
  audit.gradient = std::max(audit.gradient, window.gradient);
  audit.ceres_gradient = std::max(audit.ceres_gradient, window.ceres_gradient);
  audit.parameter_difference = std::max(audit.parameter_difference, window.parameter);
  const bool rejected =
      !(window.cost <= WindowAudit::tolerance) || !(window.gradient <= WindowAudit::gradient_tolerance);
  audit.replaced += rejected ? 1 : 0;
  // If a loss has several minima, the other solver may have found a lower minimum. This does not count as a failed
  // minimisation.
  audit.lower += window.cost < -WindowAudit::tolerance ? 1 : 0;
  return rejected;
}

}  // namespace modebank
