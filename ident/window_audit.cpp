#include "ident/window_audit.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "ident/seed.hpp"

namespace modebank {

namespace {

constexpr Index least_audit = 200;
constexpr Index audit_share = 1000;       ///< one window in so many
constexpr double negligible_cost = 1e-9;  ///< per sample

/// sum rho(|r_k / sigma|^2) + |(theta - mean) / sd|^2.
double objective(const WindowContext::WindowData& data, const Estimator& estimator, const ParameterPrior* prior,
                 const Eigen::VectorXd& theta) {
  const Transitions& t = data.transitions;
  const Index q = t.regressors.cols(), n = t.increments.cols();
  const Eigen::Map<const Eigen::MatrixXd> coefficients(theta.data(), q, n);
  const Eigen::MatrixXd r = (t.increments - t.regressors * coefficients) * data.scale.sigma.cwiseInverse().asDiagonal();
  double sum = 0.0;
  for (Index k = 0; k < r.rows(); ++k) sum += estimator.loss(r.row(k).squaredNorm()).rho;
  if (prior) sum += ((theta - prior->mean).array() / prior->sd.array()).square().sum();
  return sum;
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

double relative_cost_above(double cost, double ceres_cost, Index samples) {
  return (cost - ceres_cost) / std::max(ceres_cost, negligible_cost * static_cast<double>(samples));
}

AuditedWindow audit_window(const WindowContext& context, const Window& window, const ParameterPrior* prior,
                           const LocalModel& fit) {
  AuditedWindow result;
  const auto data = context.load(window);
  if (!data) return result;
  result.ceres = fit_transitions(data->transitions, data->decomposition, context.estimator(), data->scale, prior);
  if (result.ceres.status == FitStatus::failed) return result;
  result.compared = true;
  const double ours = objective(*data, context.estimator(), prior, fit.theta),
               theirs = objective(*data, context.estimator(), prior, result.ceres.theta);
  result.cost = relative_cost_above(ours, theirs, data->transitions.count());
  const Eigen::ArrayXd difference = (fit.theta - result.ceres.theta).cwiseAbs();
  result.parameter = (difference / result.ceres.covariance.diagonal().array().sqrt()).maxCoeff();
  return result;
}

bool add_to_audit(const AuditedWindow& window, WindowAudit& audit) {
  if (!window.compared) return false;
  ++audit.checked;
  audit.cost_difference = std::max(audit.cost_difference, std::abs(window.cost));
  audit.parameter_difference = std::max(audit.parameter_difference, window.parameter);
  const bool above = !(window.cost <= WindowAudit::tolerance);
  audit.replaced += above ? 1 : 0;
  // A lower minimum of a loss with several is no disagreement about a minimum.
  audit.lower += window.cost < -WindowAudit::tolerance ? 1 : 0;
  return above;
}

}  // namespace modebank
