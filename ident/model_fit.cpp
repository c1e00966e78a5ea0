#include "ident/model_fit.hpp"

#include <algorithm>
#include <cmath>

#include "ident/describe_fit.hpp"
#include "ident/m_estimate.hpp"
#include "ident/regression.hpp"

namespace modebank {

namespace {

/// Residuals and derivatives of a fit at its solution, in units of sigma, times the roots of the sample weights.
struct LinearisedFit {
  Eigen::VectorXd r;
  RowMajorJacobian J;
};

LinearisedFit linearise(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const Eigen::VectorXd& at) {
  LinearisedFit fit;
  residuals.evaluate(at.data(), fit.r, &fit.J);
  const Index n = residuals.states(), u = fit.J.cols();
  double *r = fit.r.data(), *J = fit.J.data();
  for (Index k = 0; k < residuals.samples(); ++k) {
    const double root_weight = std::sqrt(residuals.weight(k));
    for (Index i = 0; i < n; ++i) {
      const double scale = root_weight / sigma(i);
      *r++ *= scale;
      for (Index j = 0; j < u; ++j) *J++ *= scale;
    }
  }
  return fit;
}

/// The whitened problem whose solution z = 0 is the fit's.
WhitenedProblem whiten_at(const LinearisedFit& fit, const ModelResiduals& residuals, const Eigen::VectorXd& at,
                          const Decomposition& excitation, const ParameterPrior* prior) {
  const Index rows = fit.r.size(), u = at.size(), p = prior ? prior->mean.size() : 0;
  WhitenedProblem problem;
  problem.samples = residuals.samples();
  problem.states = residuals.states();
  problem.origin = at;
  problem.weight = residuals.weights();
  problem.b = Eigen::VectorXd(rows + p);
  problem.b.head(rows) = fit.r;
  if (!prior) {
    problem.J = excitation.U;
    problem.basis = excitation.basis;
    return problem;
  }
  problem.b.tail(p) = (prior->mean - at.head(p)).cwiseQuotient(prior->sd);
  Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(rows + p, u);
  stacked.topRows(rows) = fit.J;
  stacked.bottomLeftCorner(p, p) = prior->sd.cwiseInverse().asDiagonal();
  const Decomposition d = decompose(stacked, 0.0);
  problem.J = d.U;
  problem.basis = d.basis;
  return problem;
}

}  // namespace

ModelEstimator make_model_estimator(const MotionModel& model, const FitOptions& options) {
  RobustLoss loss(options.loss, options.loss_scale);
  const double consistency = gaussian_consistency(loss, model.states());
  // Simulations of a whole window often have several minima, and there Ceres is to choose.
  const bool newton_first = options.solver != WindowSolver::ceres && options.residual == ResidualKind::one_step;
  return {std::move(loss), consistency, options.covariance, {options.max_iterations, newton_first}};
}

LocalModel fit_model(const ModelResiduals& residuals, const ModelEstimator& estimator, const Eigen::VectorXd& sigma,
                     const Eigen::VectorXd& floor, const ParameterPrior* prior, const Eigen::VectorXd& start) {
  const Index p = residuals.model().parameter_count(), n = residuals.states();
  if (residuals.samples() == 0) return failed_fit(p, n);
  const ModelMinimum minimum = minimise_model(residuals, sigma, estimator.loss, prior, estimator.search, start);
  if (minimum.status == FitStatus::failed) return failed_fit(p, n);
  const LinearisedFit at_solution = linearise(residuals, sigma, minimum.unknowns);
  if (!at_solution.J.allFinite() || !at_solution.r.allFinite()) return failed_fit(p, n);

  const Decomposition excitation = decompose(at_solution.J, excitation_tolerance);
  const WhitenedProblem problem = whiten_at(at_solution, residuals, minimum.unknowns, excitation, prior);
  const RobustTerms terms = evaluate(problem, estimator.loss, Eigen::VectorXd::Zero(problem.unknowns()));
  const Transitions responses{{}, residuals.responses(), residuals.weights()};
  const NoiseScale scale{sigma, floor};
  const auto states = static_cast<double>(n);
  LocalModel fit = describe_fit(
      {problem, terms, responses, estimator.loss, estimator.consistency, estimator.covariance, scale, prior,
       static_cast<double>(residuals.unknowns()) / states, static_cast<double>(excitation.rank()) / states},
      minimum.unknowns.head(p));
  if (!fit.theta.allFinite()) return fit;
  fit.condition = excitation.condition;
  fit.rank = std::max(Index{0}, excitation.rank() - (residuals.unknowns() - p));
  fit.status = excitation.rank() < residuals.unknowns() ? FitStatus::rank_deficient : minimum.status;
  return fit;
}

}  // namespace modebank
