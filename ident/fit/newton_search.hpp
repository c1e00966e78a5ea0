#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "ident/fit/constants.hpp"
#include "ident/fit/motion_objective.hpp"

namespace modebank {

inline void move_within_bounds(const MotionModel& model, Eigen::VectorXd& at) {
  const auto& parameters = model.parameters();
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    double& value = at(static_cast<Index>(j));
    value = std::clamp(value, parameters[j].lower, parameters[j].upper);
  }
}

inline Eigen::VectorXd within_bounds(const MotionModel& model, Eigen::VectorXd at) {
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
    for (int steps = 0; steps < max_newton_iterations; ++steps) {
      find_free(at);
      double decrement = find_step();
      if (decrement >= 0.0 && decrement <= stationary_gradient * stationary_gradient * here_.psi_square) return true;
      if (steps >= iterations_without_curvature) {
        const double exact = find_exact_step(loss, at);
        if (exact >= 0.0) decrement = exact;
      }
      if (decrement < 0.0) {
        objective_.expand(at, loss, LossCurvature::left_out, here_);
        decrement = find_step(damping);
        if (decrement >= 0.0 && decrement <= stationary_gradient * stationary_gradient * here_.psi_square) return true;
      }
      if (decrement < 0.0 || !advance(loss, at)) return false;
    }
    return false;
  }

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

  static constexpr double cost_rounding = 1e-13;
  static constexpr int max_newton_iterations = 60;
  static constexpr int max_halvings = 8;
  static constexpr int iterations_without_curvature = 8;
  static constexpr double damping = 1e-8;              // where parameters cannot be told apart
  static constexpr double gradient_difference = 1e-6;  // of a parameter, or of its standard error

  const ModelObjective& objective_;
  ModelObjective::Expansion here_, there_;
  Eigen::VectorXd free_, scale_, step_, candidate_;
  Eigen::MatrixXd factor_, exact_;
};

}  // namespace modebank
