#include "ident/fit/motion_fit.hpp"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "ident/fit/describe.hpp"
#include "ident/fit/minimise.hpp"
#include "ident/fit/residuals.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

namespace {

/// Samples first .. first + count - 1 as a Ceres cost function: residuals in units of sigma, times the square roots of
/// their weights. All referenced objects must outlive it.
class SampleResidual final : public ceres::CostFunction {
 public:
  SampleResidual(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, Index first, Index count)
      : residuals_(residuals), sigma_(sigma), first_(first), count_(count) {
    set_num_residuals(static_cast<int>(count * residuals.states()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(residuals.unknowns()));
  }

  bool Evaluate(const double* const* parameters, double* r, double** jacobians) const override {
    double* J = jacobians ? jacobians[0] : nullptr;
    residuals_.evaluate(parameters[0], first_, count_, r, J);
    double sum = 0.0;
    for (Index k = first_; k < first_ + count_; ++k) {
      const double root_weight = std::sqrt(residuals_.weight(k));
      for (Index i = 0; i < residuals_.states(); ++i) {
        const double scale = root_weight / sigma_(i);
        *r *= scale;
        sum += *r * *r;
        ++r;
        for (Index j = 0; J && j < residuals_.unknowns(); ++j) *J++ *= -scale;
      }
    }
    return std::isfinite(sum);
  }

 private:
  const ModelResiduals& residuals_;
  const Eigen::VectorXd& sigma_;
  Index first_, count_;
};

/// The prior's residual (theta - m) / sd. The prior must outlive it.
class PriorResidual final : public ceres::CostFunction {
 public:
  explicit PriorResidual(const ParameterPrior& prior) : prior_(prior) {
    set_num_residuals(static_cast<int>(prior.mean.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(prior.mean.size()));
  }

  bool Evaluate(const double* const* parameters, double* r, double** jacobians) const override {
    const Index p = prior_.mean.size();
    const Eigen::Map<const Eigen::VectorXd> theta(parameters[0], p);
    Eigen::Map<Eigen::VectorXd>(r, p) = (theta - prior_.mean).cwiseQuotient(prior_.sd);
    if (jacobians && jacobians[0])
      Eigen::Map<RowMajorJacobian>(jacobians[0], p, p) = prior_.sd.cwiseInverse().asDiagonal();
    return true;
  }

 private:
  const ParameterPrior& prior_;
};

/// Near the optimum the expected gain of a step is a rounding error. Ceres then calls the step invalid and shrinks the
/// trust region until the step is small. The search should then end as converged.
constexpr int most_invalid_model_steps = 50;

ceres::Solver::Options model_solver_options(int iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;  // this solver does not square the condition number
  options.max_num_iterations = iterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-16;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-16;  // steps shrink slowly under robust losses
  options.max_num_consecutive_invalid_steps = most_invalid_model_steps;
  return options;
}

void set_bounds(const MotionModel& model, ceres::Problem& problem, Eigen::VectorXd& theta) {
  const auto& parameters = model.parameters();
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    const auto& [lower, upper] = std::pair(parameters[j].lower, parameters[j].upper);
    if (std::isfinite(lower)) problem.SetParameterLowerBound(theta.data(), static_cast<int>(j), lower);
    if (std::isfinite(upper)) problem.SetParameterUpperBound(theta.data(), static_cast<int>(j), upper);
  }
}

/// Minimises by Ceres. Ceres applies the loss to a whole residual block, so each sample is one block. Plain least
/// squares use one block for all samples.
FitStatus ceres_search(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const RobustLoss& loss,
                       const ParameterPrior* prior, int iterations, Eigen::VectorXd& theta) {
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;  // one object for all samples, windows and
                                                                           // threads
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  const auto add = [&](Index first, Index count, ceres::LossFunction* function) {  // Ceres owns the cost function
    problem.AddResidualBlock(new SampleResidual(residuals, sigma, first, count), function, theta.data());
  };
  if (loss.kind() == Loss::trivial)
    add(0, residuals.samples(), nullptr);
  else
    for (Index k = 0; k < residuals.samples(); ++k) add(k, 1, loss.ceres_function());
  if (prior) problem.AddResidualBlock(new PriorResidual(*prior), nullptr, theta.data());
  set_bounds(residuals.model(), problem, theta);
  ceres::Solver::Summary summary;
  ceres::Solve(model_solver_options(iterations), &problem, &summary);
  if (summary.termination_type == ceres::CONVERGENCE) return FitStatus::converged;
  return summary.termination_type == ceres::NO_CONVERGENCE ? FitStatus::iteration_limit : FitStatus::failed;
}

Eigen::VectorXd within_bounds(const MotionModel& model, Eigen::VectorXd theta) {
  const auto& parameters = model.parameters();
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    double& value = theta(static_cast<Index>(j));
    value = std::clamp(value, parameters[j].lower, parameters[j].upper);
  }
  return theta;
}

/// Residuals and derivatives of a fit at its solution, in units of sigma.
struct LinearisedFit {
  Eigen::VectorXd r;
  RowMajorJacobian J;
};

LinearisedFit linearise(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const Eigen::VectorXd& at) {
  LinearisedFit fit;
  residuals.evaluate(at.data(), fit.r, &fit.J);
  const Index n = residuals.states(), u = fit.J.cols();
  double *r = fit.r.data(), *J = fit.J.data();
  for (Index k = 0; k < residuals.samples(); ++k)
    for (Index i = 0; i < n; ++i) {
      const double scale = 1.0 / sigma(i);
      *r++ *= scale;
      for (Index j = 0; j < u; ++j) *J++ *= scale;
    }
  return fit;
}

/// The whitened problem whose solution z = 0 is the fit.
WhitenedProblem whiten_at(const LinearisedFit& fit, const ModelResiduals& residuals, const Eigen::VectorXd& at,
                          const Decomposition& excitation, const ParameterPrior* prior) {
  const Index rows = fit.r.size(), u = at.size(), p = prior ? prior->mean.size() : 0;
  WhitenedProblem problem;
  problem.samples = residuals.samples();
  problem.states = residuals.states();
  problem.origin = at;
  problem.b = Eigen::VectorXd(rows + p);
  problem.b.head(rows) = fit.r;
  if (!prior) {
    problem.J = excitation.U;
    problem.basis = excitation.basis;
    return problem;
  }
  problem.b.tail(p) = (prior->mean - at).cwiseQuotient(prior->sd);
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
  if (!loss.convex())
    minimum.theta = minimise_model(residuals, sigma, RobustLoss(Loss::huber, 0.0), prior, max_iterations, start).theta;
  minimum.status = ceres_search(residuals, sigma, loss, prior, max_iterations, minimum.theta);
  if (!minimum.theta.allFinite()) minimum.status = FitStatus::failed;
  return minimum;
}

LocalModel fit_model(const ModelResiduals& residuals, const ModelEstimator& estimator, const Eigen::VectorXd& sigma,
                     const Eigen::VectorXd& floor, const ParameterPrior* prior, const Eigen::VectorXd& start) {
  const Index p = residuals.model().parameter_count(), n = residuals.states();
  if (residuals.samples() == 0) return failed_fit(p, n);
  const ModelMinimum minimum = minimise_model(residuals, sigma, estimator.loss, prior, estimator.max_iterations, start);
  if (minimum.status == FitStatus::failed) return failed_fit(p, n);
  const LinearisedFit at_solution = linearise(residuals, sigma, minimum.theta);
  if (!at_solution.J.allFinite() || !at_solution.r.allFinite()) return failed_fit(p, n);

  const Decomposition excitation = decompose(at_solution.J, excitation_tolerance);
  const WhitenedProblem problem = whiten_at(at_solution, residuals, minimum.theta, excitation, prior);
  const RobustTerms terms = evaluate(problem, estimator.loss, Eigen::VectorXd::Zero(problem.unknowns()));
  const Transitions responses{{}, residuals.responses()};
  const NoiseScale scale{sigma, floor};
  const auto states = static_cast<double>(n);
  LocalModel fit = describe_fit({.problem = problem,
                                 .terms = terms,
                                 .transitions = responses,
                                 .consistency = estimator.consistency,
                                 .covariance = estimator.covariance,
                                 .scale = scale,
                                 .prior = prior,
                                 .unknowns_per_state = static_cast<double>(p) / states,
                                 .rank_per_state = static_cast<double>(excitation.rank()) / states},
                                minimum.theta);
  if (!fit.theta.allFinite()) return fit;
  fit.condition = excitation.condition;
  fit.rank = excitation.rank();
  fit.status = excitation.rank() < p ? FitStatus::rank_deficient : minimum.status;
  return fit;
}

}  // namespace modebank
