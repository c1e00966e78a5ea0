#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>

#include "ident/fit/whitened_problem.hpp"

namespace modebank {

/// Rows first .. first + count - 1 of r(z) = b - J z as a Ceres cost function with its constant Jacobian -J. The
/// problem must outlive it.
class LinearResidual final : public ceres::CostFunction {
 public:
  LinearResidual(const WhitenedProblem& problem, Index first, Index count) : problem_(&problem), first_(first) {
    set_num_residuals(static_cast<int>(count));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.unknowns()));
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> z(parameters[0], problem_->unknowns());
    const auto J = problem_->J.middleRows(first_, num_residuals());
    Eigen::Map<Eigen::VectorXd> r(residuals, num_residuals());
    r.noalias() = problem_->b.segment(first_, num_residuals()) - J * z;
    if (jacobians && jacobians[0]) Eigen::Map<RowMajorMatrix>(jacobians[0], num_residuals(), problem_->unknowns()) = -J;
    return true;
  }

 private:
  const WhitenedProblem* problem_;
  Index first_;
};

}  // namespace modebank
