#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <cmath>
#include <utility>

#include "ident/model_fit.hpp"
#include "ident/newton_search.hpp"

namespace modebank {

namespace {

constexpr int steps_of_a_linear_model = 2;

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

/// A model that is not linear may have a lower minimum near where the search began than near least squares, or a higher
/// one: `at` moves to the lower.
void take_lower_start(const ModelObjective& objective, const RobustLoss& loss, NewtonSearch& newton,
                      Eigen::VectorXd other, Eigen::VectorXd& at) {
  newton(loss, at);
  newton(loss, other);
  if (!(objective.cost(at, loss) <= objective.cost(other, loss))) at.swap(other);
}

/// From minimum.unknowns, by `search`; fills the rest of `minimum`.
void find_minimum(const ModelObjective& objective, const RobustLoss& loss, const ModelSearch& search,
                  NewtonSearch& newton, ModelMinimum& minimum) {
  Eigen::VectorXd& at = minimum.unknowns;
  const Eigen::VectorXd start = at;
  bool stationary = search.newton_first && newton(loss, at);
  if (!stationary) at = start;
  minimum.status = FitStatus::converged;
  if (!stationary && !std::isfinite(objective.cost(at, loss))) minimum.status = FitStatus::failed;
  for (const SearchEffort& effort : {near_effort, far_effort}) {
    if (stationary || minimum.status == FitStatus::failed) break;
    minimum.status = ceres_search(objective, loss, effort, search.iterations, at);
    stationary = minimum.status != FitStatus::failed && newton(loss, at);
  }
  if (stationary) minimum.status = FitStatus::converged;
  if (!at.allFinite()) minimum.status = FitStatus::failed;
  if (minimum.status != FitStatus::failed) minimum.cost = stationary ? newton.cost() : objective.cost(at, loss);
}

}  // namespace

ModelMinimum minimise_model(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const RobustLoss& loss,
                            const ParameterPrior* prior, const ModelSearch& search, const Eigen::VectorXd& start) {
  static const RobustLoss squares(Loss::trivial, 0.0), huber(Loss::huber, 0.0);
  const ModelObjective objective(residuals, sigma, prior);
  NewtonSearch newton(objective);
  ModelMinimum minimum{within_bounds(residuals.model(), start), FitStatus::failed};
  if (search.newton_first && loss.kind() != Loss::trivial) {
    // From afar most samples would seem to be outliers, and each of Newton's steps on a robust loss be short.
    newton(squares, minimum.unknowns);
    if (newton.steps() > steps_of_a_linear_model)
      take_lower_start(objective, loss.convex() ? loss : huber, newton, within_bounds(residuals.model(), start),
                       minimum.unknowns);
  }
  if (!loss.convex()) find_minimum(objective, huber, search, newton, minimum);
  find_minimum(objective, loss, search, newton, minimum);
  return minimum;
}

}  // namespace modebank
