#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "ident/model_fit.hpp"
#include "ident/model_objective.hpp"

namespace modebank {

namespace {

constexpr double stationary_share = 1e-10;  // of |psi|
constexpr double cost_rounding = 1e-13;
constexpr int max_newton_iterations = 60;
constexpr int max_halvings = 8;
constexpr int iterations_without_curvature = 8;
constexpr double damping = 1e-8;  // where parameters cannot be told apart
constexpr int steps_of_a_linear_model = 2;
constexpr double gradient_difference = 1e-6;  // of a parameter, or of its standard error

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

void move_within_bounds(const MotionModel& model, Eigen::VectorXd& at) {
  const auto& parameters = model.parameters();
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    double& value = at(static_cast<Index>(j));
    value = std::clamp(value, parameters[j].lower, parameters[j].upper);
  }
}

Eigen::VectorXd within_bounds(const MotionModel& model, Eigen::VectorXd at) {
  move_within_bounds(model, at);
  return at;
}

/// Newton's steps on one objective; its memory is used again by the next search. Parameters at a bound that the
/// objective falls beyond stay there (projected Newton: Bertsekas 1982, SIAM J. Control Optim. 20).
class NewtonSearch {
 public:
  explicit NewtonSearch(const ModelObjective& objective) : objective_(objective) {}

  /// Damped steps from `at` until the gradient is rounding error (true) or nothing is gained any more. Steps that leave
  /// the model's own curvature out get slowly near where it matters; then it is taken from differences of gradients.
  bool operator()(const RobustLoss& loss, Eigen::VectorXd& at) {
    objective_.expand(at, loss, LossCurvature::taken, here_);
    if (!std::isfinite(here_.cost)) return false;
    for (steps_ = 0; steps_ < max_newton_iterations; ++steps_) {
      find_free(at);
      double decrement = find_step();
      if (decrement >= 0.0 && decrement <= stationary_share * stationary_share * here_.psi_square) return true;
      if (steps_ >= iterations_without_curvature) {
        const double exact = find_exact_step(loss, at);
        if (exact >= 0.0) decrement = exact;
      }
      if (decrement < 0.0) {
        objective_.expand(at, loss, LossCurvature::left_out, here_);
        decrement = find_step(damping);
        if (decrement >= 0.0 && decrement <= stationary_share * stationary_share * here_.psi_square) return true;
      }
      if (decrement < 0.0 || !advance(loss, at)) return false;
    }
    return false;
  }

  int steps() const { return steps_; }  ///< of the last search

 private:
  using LossCurvature = ModelObjective::LossCurvature;

  /// 1 where a parameter may move, 0 where it is held by its bound.
  void find_free(const Eigen::VectorXd& at) {
    free_.setOnes(at.size());
    const auto& parameters = objective_.model().parameters();
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const auto j = static_cast<Index>(k);
      const bool held = (at(j) <= parameters[k].lower && here_.gradient(j) > 0.0) ||
                        (at(j) >= parameters[k].upper && here_.gradient(j) < 0.0);
      const bool without_effect = here_.gradient(j) == 0.0 && here_.hessian(j, j) == 0.0;
      if (held || without_effect) free_(j) = 0.0;
    }
  }

  /// The Newton step -H^-1 g; returns its decrement g' H^-1 g, negative where H is not positive definite. `more`: added
  /// to H as a share of its diagonal.
  double find_step(double more = 0.0) {
    const Eigen::MatrixXd& H = here_.hessian;
    const Index u = H.cols();
    if (!H.allFinite()) return -1.0;
    scale_.resize(u);
    for (Index j = 0; j < u; ++j) {
      if (free_(j) != 0.0 && !(H(j, j) > 0.0)) return -1.0;
      scale_(j) = free_(j) != 0.0 ? 1.0 / std::sqrt(H(j, j)) : 0.0;
    }
    factor_.resize(u, u);
    for (Index j = 0; j < u; ++j) {
      for (Index i = j; i < u; ++i) factor_(i, j) = H(i, j) * scale_(i) * scale_(j);
      factor_(j, j) = free_(j) == 0.0 ? 1.0 : factor_(j, j) + more;
    }
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(factor_);  // in place
    if (factor.info() != Eigen::Success) return -1.0;
    step_ = scale_.cwiseProduct(here_.gradient);
    factor.solveInPlace(step_);
    step_.array() *= -scale_.array();
    return -here_.gradient.dot(step_);
  }

  /// find_step with the whole second derivative.
  double find_exact_step(const RobustLoss& loss, const Eigen::VectorXd& at) {
    const auto& parameters = objective_.model().parameters();
    Eigen::MatrixXd& H = there_.hessian;  // its place is free until the step is taken
    exact_.resize(at.size(), at.size());
    for (Index j = 0; j < at.size(); ++j) {
      const bool bounded = j < static_cast<Index>(parameters.size());
      const double upper = bounded ? parameters[static_cast<std::size_t>(j)].upper : HUGE_VAL;
      double h =
          gradient_difference * std::max(std::abs(at(j)), 1.0 / std::sqrt(std::max(here_.hessian(j, j), 1e-300)));
      if (at(j) + h > upper) h = -h;
      candidate_ = at;
      candidate_(j) += h;
      objective_.expand(candidate_, loss, LossCurvature::taken, there_);
      exact_.col(j) = (there_.gradient - here_.gradient) / (candidate_(j) - at(j));
    }
    H = 0.5 * (exact_ + exact_.transpose());
    H.swap(here_.hessian);
    const double decrement = find_step();
    H.swap(here_.hessian);
    return decrement;
  }

  /// Moves along step_; where that leads nowhere (a bound bends it, or parameters can hardly be told apart) along
  /// Levenberg's and Marquardt's.
  bool advance(const RobustLoss& loss, Eigen::VectorXd& at) {
    if (take_step(loss, at)) return true;
    for (const double more : {1e-3, 1e-1, 1e1, 1e3})
      if (find_step(more) >= 0.0 && take_step(loss, at)) return true;
    return false;
  }

  /// Moves along step_, halved until the objective no longer grows; false where it cannot.
  bool take_step(const RobustLoss& loss, Eigen::VectorXd& at) {
    if (!step_.allFinite()) return false;
    const double allowed = here_.cost * (1.0 + cost_rounding);
    for (int halving = 0;; ++halving) {
      candidate_ = at + step_;
      move_within_bounds(objective_.model(), candidate_);
      objective_.expand(candidate_, loss, LossCurvature::taken, there_);
      if (there_.cost <= allowed) break;
      if (halving == max_halvings) return false;
      step_ *= 0.5;
    }
    if (candidate_ == at) return false;
    at.swap(candidate_);
    std::swap(here_, there_);
    return true;
  }

  const ModelObjective& objective_;
  ModelObjective::Expansion here_, there_;
  int steps_ = 0;
  Eigen::VectorXd free_, scale_, step_, candidate_;
  Eigen::MatrixXd factor_, exact_;
};

/// A model that is not linear may have a lower minimum near where the search began than near least squares, or a higher
/// one: `at` moves to the lower.
void take_lower_start(const ModelObjective& objective, const RobustLoss& loss, NewtonSearch& newton,
                      Eigen::VectorXd other, Eigen::VectorXd& at) {
  newton(loss, at);
  newton(loss, other);
  if (!(objective.cost(at, loss) <= objective.cost(other, loss))) at.swap(other);
}

/// From `at`, by `search`.
FitStatus find_minimum(const ModelObjective& objective, const RobustLoss& loss, const ModelSearch& search,
                       NewtonSearch& newton, Eigen::VectorXd& at) {
  if (search.newton_first) {
    const Eigen::VectorXd start = at;
    if (newton(loss, at)) return FitStatus::converged;
    at = start;
  }
  FitStatus status = FitStatus::failed;
  for (const SearchEffort& effort : {near_effort, far_effort}) {
    status = ceres_search(objective, loss, effort, search.iterations, at);
    if (status == FitStatus::failed) break;
    if (newton(loss, at)) return FitStatus::converged;
  }
  return status;
}

}  // namespace

ModelMinimum minimise_model(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const RobustLoss& loss,
                            const ParameterPrior* prior, const ModelSearch& search, const Eigen::VectorXd& start) {
  static const RobustLoss squares(Loss::trivial, 0.0), huber(Loss::huber, 0.0);
  const ModelObjective objective(residuals, sigma, prior);
  NewtonSearch newton(objective);
  ModelMinimum minimum{within_bounds(residuals.model(), start), FitStatus::failed};
  Eigen::VectorXd& at = minimum.unknowns;
  if (search.newton_first && loss.kind() != Loss::trivial) {
    // From afar most samples would seem to be outliers, and each of Newton's steps on a robust loss be short.
    newton(squares, at);
    if (newton.steps() > steps_of_a_linear_model)
      take_lower_start(objective, loss.convex() ? loss : huber, newton, within_bounds(residuals.model(), start), at);
  }
  if (!loss.convex()) find_minimum(objective, huber, search, newton, at);
  if (!std::isfinite(objective.cost(at, loss))) return minimum;
  minimum.status = find_minimum(objective, loss, search, newton, at);
  if (!at.allFinite()) minimum.status = FitStatus::failed;
  if (minimum.status != FitStatus::failed) minimum.cost = objective.cost(at, loss);
  return minimum;
}

}  // namespace modebank
