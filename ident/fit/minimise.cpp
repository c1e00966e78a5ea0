#include "ident/fit/minimise.hpp"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "ident/base/linalg.hpp"
#include "ident/fit/constants.hpp"
#include "ident/fit/residuals.hpp"

namespace modebank {

namespace {

/// Whitened residuals above this value are numerical accidents; their squares would overflow.
constexpr double largest_residual = 1e100;
/// Relative cost changes at which Ceres stops. The first tolerance brings the search near enough for Newton steps. If
/// the Newton steps fail, Ceres continues with the second tolerance, down to the precision of the cost.
constexpr double near_tolerance = 1e-4;
constexpr double far_tolerance = 1e-14;
/// If |psi| is below this share of |b|, it cannot serve as a reference for the gradient: even stationary_gradient times
/// |psi| is a rounding error.
constexpr double least_influence = 1e-5;
/// Near the optimum the expected gain of a step is a rounding error. Ceres then calls the step invalid and shrinks the
/// trust region. The search should end as it does after any small step, without a failure.
constexpr int most_invalid_steps = 50;
constexpr double cost_rounding = 1e-13;
constexpr int max_newton_steps = 60;
constexpr int max_halvings = 30;

ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  // The loss is shared by all samples, windows and threads.
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

/// Termination of Ceres: relative change of the cost, gradient, relative step.
struct Tolerances {
  double function, gradient = 1e-14, parameter = 1e-12;
};

ceres::Solver::Options solver_options(const Tolerances& tolerances, int max_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;  // safe, because J has orthonormal columns
  options.max_num_iterations = max_iterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.jacobi_scaling = false;             // the columns already have unit norm
  options.initial_trust_region_radius = 1e8;  // begins with full steps, because the problem is convex or the start is
                                              // near the optimum
  options.function_tolerance = tolerances.function;
  options.gradient_tolerance = tolerances.gradient;
  options.max_num_consecutive_invalid_steps = most_invalid_steps;
  options.parameter_tolerance = tolerances.parameter;
  return options;
}

FitStatus search(const WhitenedProblem& problem, const RobustLoss& loss, const Tolerances& tolerances,
                 int max_iterations, Eigen::VectorXd& z) {
  ceres::Problem ceres_problem(problem_options());
  const auto add = [&](Index first, Index count, ceres::LossFunction* function) {
    // Ceres owns this block
    ceres_problem.AddResidualBlock(new LinearResidual(problem, first, count), function, z.data());
  };
  for (Index k = 0; k < problem.samples; ++k) add(k * problem.states, problem.states, loss.ceres_function());
  if (problem.prior_rows() > 0) add(problem.sample_rows(), problem.prior_rows(), nullptr);
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(tolerances, max_iterations), &ceres_problem, &summary);
  if (summary.termination_type == ceres::CONVERGENCE) return FitStatus::converged;
  return summary.termination_type == ceres::NO_CONVERGENCE ? FitStatus::iteration_limit : FitStatus::failed;
}

bool stationary(const WhitenedProblem& problem, const RobustTerms& terms) {
  return scaled_gradient(problem, terms) <= stationary_gradient;
}

/// The step -H^-1 g. If the second derivative is not positive definite, H omits rho''. Empty if this H is not positive
/// definite either.
Eigen::VectorXd newton_step(const WhitenedProblem& problem, const RobustTerms& terms, const Eigen::VectorXd& g) {
  Cholesky factor(hessian(problem, terms));
  if (!factor.definite()) factor.factorise(weighted_information(problem, terms));
  return factor.definite() ? Eigen::VectorXd(-factor.solve(g)) : Eigen::VectorXd();
}

/// Newton steps, halved until the objective does not increase. Returns true if z is stationary at the end, and false if
/// no step reduces the cost.
bool polish(const WhitenedProblem& problem, const RobustLoss& loss, Eigen::VectorXd& z) {
  RobustTerms terms = evaluate(problem, loss, z);
  for (int i = 0; i < max_newton_steps; ++i) {
    if (stationary(problem, terms)) return true;
    Eigen::VectorXd step = newton_step(problem, terms, gradient(problem, terms));
    if (step.size() == 0 || !step.allFinite()) return false;
    const double allowed = half_cost(problem, loss, terms) * (1.0 + cost_rounding);
    RobustTerms candidate = evaluate(problem, loss, z + step);
    for (int halving = 0; !(half_cost(problem, loss, candidate) <= allowed); ++halving) {
      if (halving == max_halvings) return false;
      step *= 0.5;
      candidate = evaluate(problem, loss, z + step);
    }
    z += step;
    terms = std::move(candidate);
  }
  return stationary(problem, terms);
}

/// Whether the squares of all numbers are finite.
bool sound(const WhitenedProblem& problem) {
  return problem.b.cwiseAbs().maxCoeff() < largest_residual && problem.J.allFinite();
}

Minimum finite_or_failed(Minimum minimum) {
  if (!minimum.z.allFinite()) minimum.status = FitStatus::failed;
  return minimum;
}

}  // namespace

Eigen::MatrixXd RobustTerms::influence_slope(Index k, Index states) const {
  const auto r = sample(k, states);
  Eigen::MatrixXd slope = 2.0 * curvature(k) * r * r.transpose();
  slope.diagonal().array() += weight(k);
  return slope;
}

RobustTerms evaluate(const WhitenedProblem& problem, const RobustLoss& loss, const Eigen::VectorXd& z) {
  Eigen::VectorXd residual = problem.b;
  residual.noalias() -= problem.J * z;
  return evaluate_at(problem, loss, std::move(residual));
}

RobustTerms evaluate_at(const WhitenedProblem& problem, const RobustLoss& loss, Eigen::VectorXd residual) {
  RobustTerms terms{std::move(residual), Eigen::VectorXd(problem.samples), Eigen::VectorXd(problem.samples)};
  for (Index k = 0; k < problem.samples; ++k) {
    const LossValue value = loss(terms.sample(k, problem.states).squaredNorm());
    terms.weight(k) = value.weight;
    terms.curvature(k) = value.curvature;
  }
  return terms;
}

double half_cost(const WhitenedProblem& problem, const RobustLoss& loss, const RobustTerms& terms) {
  double sum = terms.residual.tail(problem.prior_rows()).squaredNorm();
  for (Index k = 0; k < problem.samples; ++k) sum += loss(terms.sample(k, problem.states).squaredNorm()).rho;
  return 0.5 * sum;
}

double scaled_gradient(const WhitenedProblem& problem, const RobustTerms& terms) {
  double psi_square = terms.residual.tail(problem.prior_rows()).squaredNorm();
  for (Index k = 0; k < problem.samples; ++k)
    psi_square += terms.weight(k) * terms.weight(k) * terms.sample(k, problem.states).squaredNorm();
  const double scale = std::max(std::sqrt(psi_square), least_influence * problem.b.norm());
  return scale > 0.0 ? gradient(problem, terms).norm() / scale : 0.0;
}

Eigen::VectorXd gradient(const WhitenedProblem& problem, const RobustTerms& terms) {
  Eigen::VectorXd psi = terms.residual;
  for (Index k = 0; k < problem.samples; ++k) psi.segment(k * problem.states, problem.states) *= terms.weight(k);
  return -(problem.J.transpose() * psi);
}

Eigen::MatrixXd weighted_information(const WhitenedProblem& problem, const RobustTerms& terms) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(problem.J.rows());
  for (Index k = 0; k < problem.samples; ++k)
    weights.segment(k * problem.states, problem.states).setConstant(terms.weight(k));
  return problem.J.transpose() * weights.asDiagonal() * problem.J;
}

Eigen::MatrixXd hessian(const WhitenedProblem& problem, const RobustTerms& terms) {
  Eigen::MatrixXd H = weighted_information(problem, terms);
  for (Index k = 0; k < problem.samples; ++k) {
    if (terms.curvature(k) == 0.0) continue;
    const Eigen::VectorXd direction =
        problem.J.middleRows(k * problem.states, problem.states).transpose() * terms.sample(k, problem.states);
    H.noalias() += 2.0 * terms.curvature(k) * direction * direction.transpose();
  }
  return H;
}

Minimum minimise(const WhitenedProblem& problem, const RobustLoss& loss, int max_iterations) {
  Minimum minimum{Eigen::VectorXd::Zero(problem.unknowns()), FitStatus::failed};
  if (!sound(problem)) return minimum;
  minimum.status = FitStatus::converged;
  if (problem.unknowns() == 0) return minimum;
  if (!loss.convex()) minimum.z = minimise(problem, RobustLoss(Loss::huber, 0.0), max_iterations).z;
  for (const double tolerance : {near_tolerance, far_tolerance}) {
    minimum.status = search(problem, loss, {tolerance}, max_iterations, minimum.z);
    if (minimum.status != FitStatus::converged || polish(problem, loss, minimum.z)) return finite_or_failed(minimum);
  }
  minimum.status = FitStatus::iteration_limit;  // Ceres cannot reduce the cost further, but the point is not stationary
  return finite_or_failed(minimum);
}

}  // namespace modebank
