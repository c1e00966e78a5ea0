#include "ident/fit/motion_fit.hpp"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "ident/fit/describe.hpp"
#include "ident/fit/minimise.hpp"
#include "ident/fit/newton_search.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

namespace {

/// The whole window as one block for Ceres: a block per sample would cost more than the arithmetic.
class WindowCost final : public ceres::CostFunction {
 public:
  WindowCost(const ModelObjective& objective, const RobustLoss& loss) : objective_(objective), loss_(loss) {
    set_num_residuals(static_cast<int>(objective.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(objective.unknowns()));
  }
  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    objective_.least_squares_rows(parameters[0], loss_, residuals, jacobians ? jacobians[0] : nullptr);
    return std::isfinite(Eigen::Map<const Eigen::VectorXd>(residuals, num_residuals()).squaredNorm());
  }

 private:
  const ModelObjective& objective_;
  const RobustLoss& loss_;
};

/// How closely Ceres searches: first near enough for Newton's steps to do the rest, and where they do not, as far as
/// costs can be told apart, by a decomposition that does not square the condition.
struct SearchEffort {
  double function_tolerance;
  ceres::LinearSolverType linear_solver;
};
constexpr SearchEffort near_effort{0.1, ceres::DENSE_NORMAL_CHOLESKY}, far_effort{1e-14, ceres::DENSE_QR};

ceres::Solver::Options model_solver_options(const SearchEffort& effort, int iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = effort.linear_solver;
  options.max_num_iterations = iterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = effort.function_tolerance;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  return options;
}

FitStatus ceres_search(const ModelObjective& objective, const RobustLoss& loss, const SearchEffort& effort,
                       int iterations, Eigen::VectorXd& at) {
  ceres::Problem::Options problem_options;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(new WindowCost(objective, loss), nullptr, at.data());  // Ceres owns it
  const auto& parameters = objective.model().parameters();
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    if (std::isfinite(parameters[j].lower))
      problem.SetParameterLowerBound(at.data(), static_cast<int>(j), parameters[j].lower);
    if (std::isfinite(parameters[j].upper))
      problem.SetParameterUpperBound(at.data(), static_cast<int>(j), parameters[j].upper);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(model_solver_options(effort, iterations), &problem, &summary);
  if (summary.termination_type == ceres::CONVERGENCE) return FitStatus::converged;
  return summary.termination_type == ceres::NO_CONVERGENCE ? FitStatus::iteration_limit : FitStatus::failed;
}

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
  return {std::move(loss), consistency, options.covariance, options.max_iterations};
}

ModelMinimum minimise_model(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const RobustLoss& loss,
                            const ParameterPrior* prior, int max_iterations, const Eigen::VectorXd& start) {
  ModelMinimum minimum{within_bounds(residuals.model(), start), FitStatus::failed};
  Eigen::VectorXd& at = minimum.unknowns;
  if (!loss.convex())
    at = minimise_model(residuals, sigma, RobustLoss(Loss::huber, 0.0), prior, max_iterations, start).unknowns;
  const ModelObjective objective(residuals, sigma, prior);
  NewtonSearch newton(objective);
  if (!std::isfinite(objective.cost(at, loss))) return minimum;
  bool stationary = false;
  for (const SearchEffort& effort : {near_effort, far_effort}) {
    minimum.status = ceres_search(objective, loss, effort, max_iterations, at);
    stationary = minimum.status != FitStatus::failed && newton(loss, at);
    if (stationary || minimum.status == FitStatus::failed) break;
  }
  if (stationary) minimum.status = FitStatus::converged;
  if (!at.allFinite()) minimum.status = FitStatus::failed;
  return minimum;
}

LocalModel fit_model(const ModelResiduals& residuals, const ModelEstimator& estimator, const Eigen::VectorXd& sigma,
                     const Eigen::VectorXd& floor, const ParameterPrior* prior, const Eigen::VectorXd& start) {
  const Index p = residuals.model().parameter_count(), n = residuals.states();
  if (residuals.samples() == 0) return failed_fit(p, n);
  const ModelMinimum minimum = minimise_model(residuals, sigma, estimator.loss, prior, estimator.max_iterations, start);
  if (minimum.status == FitStatus::failed) return failed_fit(p, n);
  const LinearisedFit at_solution = linearise(residuals, sigma, minimum.unknowns);
  if (!at_solution.J.allFinite() || !at_solution.r.allFinite()) return failed_fit(p, n);

  const Decomposition excitation = decompose(at_solution.J, excitation_tolerance);
  const WhitenedProblem problem = whiten_at(at_solution, residuals, minimum.unknowns, excitation, prior);
  const RobustTerms terms = evaluate(problem, estimator.loss, Eigen::VectorXd::Zero(problem.unknowns()));
  const Transitions responses{{}, residuals.responses(), residuals.weights()};
  const NoiseScale scale{sigma, floor};
  const auto states = static_cast<double>(n);
  LocalModel fit = describe_fit({.problem = problem,
                                 .terms = terms,
                                 .transitions = responses,
                                 .loss = estimator.loss,
                                 .consistency = estimator.consistency,
                                 .covariance = estimator.covariance,
                                 .scale = scale,
                                 .prior = prior,
                                 .unknowns_per_state = static_cast<double>(residuals.unknowns()) / states,
                                 .rank_per_state = static_cast<double>(excitation.rank()) / states},
                                minimum.unknowns.head(p));
  if (!fit.theta.allFinite()) return fit;
  fit.solved = minimum.status == FitStatus::converged;
  fit.condition = excitation.condition;
  fit.rank = std::max(Index{0}, excitation.rank() - (residuals.unknowns() - p));
  fit.status = excitation.rank() < residuals.unknowns() ? FitStatus::rank_deficient : minimum.status;
  return fit;
}

}  // namespace modebank
