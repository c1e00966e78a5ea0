#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "ident/model_fit.hpp"

namespace modebank {

namespace {

constexpr double smallest_square = 1e-4;    // of a whitened residual; below it sqrt(rho / s) is a series
constexpr double stationary_share = 1e-10;  // of the gradient's standard deviation
constexpr double cost_rounding = 1e-13;
constexpr int max_newton_iterations = 60;
constexpr int max_halvings = 8;

/// Where a model's fit is: whitened residuals, derivatives and robust terms at the unknowns.
class Objective {
 public:
  Objective(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const RobustLoss& loss,
            const ParameterPrior* prior)
      : residuals_(residuals),
        inverse_sigma_(sigma.cwiseInverse()),
        loss_(loss),
        prior_(prior),
        n_(residuals.states()),
        unknowns_(residuals.unknowns()) {}

  Index unknowns() const { return unknowns_; }
  Index prior_rows() const { return prior_ ? prior_->mean.size() : 0; }
  Index rows() const { return residuals_.rows() + prior_rows(); }
  Index samples() const { return residuals_.samples(); }
  const MotionModel& model() const { return residuals_.model(); }

  /// Fills r and J in units of sigma.
  void linearise(const double* at, bool with_derivatives) const {
    residuals_.evaluate(at, r_, with_derivatives ? &J_ : nullptr);
    const Index n = n_;
    const Index columns = with_derivatives ? J_.cols() : 0;
    for (Index k = 0, row = 0; k < samples(); ++k)
      for (Index i = 0; i < n; ++i, ++row) {
        r_(row) *= inverse_sigma_(i);
        for (Index j = 0; j < columns; ++j) J_(row, j) *= inverse_sigma_(i);
      }
  }

  /// Rows f with 1/2 |f|^2 the objective: r sqrt(rho(s) / s) per sample, then the prior's. Written out entry by entry,
  /// as `quadratic` is: windows are small, and matrix expressions of unknown size cost more than the arithmetic.
  void least_squares_rows(const double* at, double* f, double* jacobian) const {
    linearise(at, jacobian != nullptr);
    const Index n = n_, u = unknowns_;
    for (Index k = 0; k < samples(); ++k) {
      const double* const r = r_.data() + k * n;
      const double s = square(r, n);
      const LossValue value = loss_(s);
      const bool small = s < smallest_square;
      const double root_weight = std::sqrt(residuals_.weight(k));
      const double h = root_weight * (small ? 1.0 + 0.25 * value.curvature * s : std::sqrt(value.rho / s));
      for (Index i = 0; i < n; ++i) f[k * n + i] = h * r[i];
      if (!jacobian) continue;
      const double slope =
          root_weight *
          (small ? 0.25 * value.curvature : 0.5 * (value.weight * s - value.rho) / (s * std::sqrt(s * value.rho)));
      for (Index j = 0; j < u; ++j) {
        const double along = 2.0 * slope * pull(r, k, j);
        for (Index i = 0; i < n; ++i) jacobian[(k * n + i) * u + j] = -h * J_(k * n + i, j) - along * r[i];
      }
    }
    for (Index j = 0; j < prior_rows(); ++j) {
      f[residuals_.rows() + j] = (at[j] - prior_->mean(j)) / prior_->sd(j);
      if (!jacobian) continue;
      double* const row = jacobian + (residuals_.rows() + j) * u;
      std::fill(row, row + u, 0.0);
      row[j] = 1.0 / prior_->sd(j);
    }
  }

  double cost(const Eigen::VectorXd& at) const {
    linearise(at.data(), false);
    const Index n = n_;
    double sum = 0.0;
    for (Index k = 0; k < samples(); ++k) sum += residuals_.weight(k) * loss_(square(r_.data() + k * n, n)).rho;
    if (prior_) sum += ((at.head(prior_rows()) - prior_->mean).array() / prior_->sd.array()).square().sum();
    return 0.5 * sum;
  }

  /// Cost, gradient, and the second derivative without the model's own curvature; `exact`: with the loss'.
  double quadratic(const Eigen::VectorXd& at, bool exact, Eigen::VectorXd& g, Eigen::MatrixXd& H) const {
    linearise(at.data(), true);
    const Index n = n_, u = unknowns_;
    g.setZero(u);
    H.setZero(u, u);
    double sum = 0.0;
    for (Index k = 0; k < samples(); ++k) {
      const double* const r = r_.data() + k * n;
      const LossValue value = loss_(square(r, n));
      const double weight = residuals_.weight(k) * value.weight;
      const double curvature = exact ? 2.0 * residuals_.weight(k) * value.curvature : 0.0;
      sum += residuals_.weight(k) * value.rho;
      for (Index j = 0; j < u; ++j) {
        const double along = pull(r, k, j);
        g(j) -= weight * along;
        for (Index l = 0; l <= j; ++l) {
          double entry = curvature == 0.0 ? 0.0 : curvature * along * pull(r, k, l);
          for (Index i = 0; i < n; ++i) entry += weight * J_(k * n + i, j) * J_(k * n + i, l);
          H(j, l) += entry;
        }
      }
    }
    for (Index j = 0; j < prior_rows(); ++j) {
      const double precision = 1.0 / (prior_->sd(j) * prior_->sd(j)), away = at(j) - prior_->mean(j);
      g(j) += precision * away;
      H(j, j) += precision;
      sum += precision * away * away;
    }
    H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
    return 0.5 * sum;
  }

 private:
  static double square(const double* r, Index n) {
    double sum = 0.0;
    for (Index i = 0; i < n; ++i) sum += r[i] * r[i];
    return sum;
  }
  /// Entry j of J_k' r_k.
  double pull(const double* r, Index k, Index j) const {
    double sum = 0.0;
    for (Index i = 0; i < n_; ++i) sum += J_(k * n_ + i, j) * r[i];
    return sum;
  }

  const ModelResiduals& residuals_;
  Eigen::VectorXd inverse_sigma_;
  const RobustLoss& loss_;
  const ParameterPrior* prior_;
  Index n_, unknowns_;
  mutable Eigen::VectorXd r_;  // workspace
  mutable RowMajorJacobian J_;
};

/// The whole window as one block for Ceres: a block per sample would cost more than the arithmetic.
class WindowCost final : public ceres::CostFunction {
 public:
  explicit WindowCost(const Objective& objective) : objective_(objective) {
    set_num_residuals(static_cast<int>(objective.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(objective.unknowns()));
  }
  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    objective_.least_squares_rows(parameters[0], residuals, jacobians ? jacobians[0] : nullptr);
    return std::isfinite(Eigen::Map<const Eigen::VectorXd>(residuals, num_residuals()).squaredNorm());
  }

 private:
  const Objective& objective_;
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

FitStatus ceres_search(const Objective& objective, const SearchEffort& effort, int iterations, Eigen::VectorXd& at) {
  ceres::Problem::Options problem_options;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(new WindowCost(objective), nullptr, at.data());  // Ceres owns it
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

Eigen::VectorXd within_bounds(const MotionModel& model, Eigen::VectorXd at) {
  const auto& parameters = model.parameters();
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    double& value = at(static_cast<Index>(j));
    value = std::clamp(value, parameters[j].lower, parameters[j].upper);
  }
  return at;
}

/// The Newton step -H^-1 g and its decrement g' H^-1 g; negative where H is not positive definite.
double newton_step(const Eigen::VectorXd& g, const Eigen::MatrixXd& H, Eigen::VectorXd& step) {
  if (!(H.diagonal().minCoeff() > 0.0) || !H.allFinite()) return -1.0;
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> factor(scale.asDiagonal() * H * scale.asDiagonal());
  if (factor.info() != Eigen::Success) return -1.0;
  step = -(scale.asDiagonal() * factor.solve(scale.asDiagonal() * g));
  return -g.dot(step);
}

/// Damped Newton steps until the gradient is rounding error or nothing is gained any more.
bool polish_model(const Objective& objective, Eigen::VectorXd& at) {
  Eigen::VectorXd g, step, candidate_g;
  Eigen::MatrixXd H, candidate_H;
  double cost = objective.quadratic(at, true, g, H);
  for (int i = 0; i < max_newton_iterations; ++i) {
    double decrement = newton_step(g, H, step);
    if (decrement < 0.0) {
      objective.quadratic(at, false, g, H);
      decrement = newton_step(g, H, step);
    }
    if (decrement < 0.0 || !step.allFinite()) return false;
    // Squared residuals sum to about the number of samples, or to less where sigma is larger than they are.
    const double scatter = std::min(static_cast<double>(objective.samples()), 2.0 * cost);
    if (decrement <= stationary_share * stationary_share * scatter) return true;
    Eigen::VectorXd candidate = within_bounds(objective.model(), at + step);
    double candidate_cost = objective.quadratic(candidate, true, candidate_g, candidate_H);
    for (int halving = 0; halving < max_halvings && !(candidate_cost <= cost * (1.0 + cost_rounding)); ++halving) {
      step *= 0.5;
      candidate = within_bounds(objective.model(), at + step);
      candidate_cost = objective.quadratic(candidate, true, candidate_g, candidate_H);
    }
    if (!(candidate_cost <= cost * (1.0 + cost_rounding)) || candidate == at) return false;
    at.swap(candidate);
    g.swap(candidate_g);
    H.swap(candidate_H);
    cost = candidate_cost;
  }
  return false;
}

/// Where Newton's steps on a robust loss start: from afar most samples would seem to be outliers, and each step be
/// short.
Eigen::VectorXd near_least_squares(const ModelResiduals& residuals, const Eigen::VectorXd& sigma,
                                   const ParameterPrior* prior, Eigen::VectorXd at) {
  const RobustLoss squares(Loss::trivial, 0.0);
  const Objective objective(residuals, sigma, squares, prior);
  if (std::isfinite(objective.cost(at))) polish_model(objective, at);
  return at;
}

FitStatus find_minimum(const Objective& objective, const ModelSearch& search, Eigen::VectorXd& at) {
  const Eigen::VectorXd start = at;
  if (search.newton_first) {
    if (polish_model(objective, at)) return FitStatus::converged;
    at = start;
  }
  FitStatus status = FitStatus::failed;
  for (const SearchEffort& effort : {near_effort, far_effort}) {
    status = ceres_search(objective, effort, search.iterations, at);
    if (status == FitStatus::failed) break;
    if (polish_model(objective, at)) return FitStatus::converged;
  }
  return status;
}

}  // namespace

ModelMinimum minimise_model(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const RobustLoss& loss,
                            const ParameterPrior* prior, const ModelSearch& search, const Eigen::VectorXd& start) {
  ModelMinimum minimum{within_bounds(residuals.model(), start), FitStatus::failed};
  if (!loss.convex())
    minimum.unknowns = minimise_model(residuals, sigma, RobustLoss(Loss::huber, 0.0), prior, search, start).unknowns;
  else if (search.newton_first && loss.kind() != Loss::trivial)
    minimum.unknowns = near_least_squares(residuals, sigma, prior, std::move(minimum.unknowns));
  const Objective objective(residuals, sigma, loss, prior);
  if (!std::isfinite(objective.cost(minimum.unknowns))) return minimum;
  minimum.status = find_minimum(objective, search, minimum.unknowns);
  if (!minimum.unknowns.allFinite()) minimum.status = FitStatus::failed;
  if (minimum.status != FitStatus::failed) minimum.cost = objective.cost(minimum.unknowns);
  return minimum;
}

}  // namespace modebank
