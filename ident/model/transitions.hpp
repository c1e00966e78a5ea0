#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// N transitions as a linear regression, increments = regressors [A B c]' + noise.
struct Transitions {
  Eigen::MatrixXd regressors;  ///< N x q; row k is phi_k' = [z[k]' v[k]' (1)]
  Eigen::MatrixXd increments;  ///< N x n; row k is (x[k+1] - x[k])'

  Index count() const { return regressors.rows(); }
  bool finite() const { return regressors.allFinite() && increments.allFinite(); }
};

/// The indices of the rows that finite_rows keeps.
std::vector<Eigen::Index> usable_rows(const Transitions& transitions);

/// Stacks transitions start .. start + count - 1 of a run. Regressors before the start of the run are NaN.
Transitions stack_transitions(const Trajectory& run, Index start, Index count, const LinearStructure& structure);
/// Like stack_transitions, but writes into the first `count` rows of an object that is large enough. Does not allocate.
void fill_transitions(const Trajectory& run, Index start, Index count, const LinearStructure& structure,
                      Transitions& transitions);
/// finite_rows of all transitions of the training runs.
Transitions stack_training(const Recording& recording, const LinearStructure& structure);
/// The rows with finite entries.
Transitions finite_rows(const Transitions& transitions);

/// Visits the transitions of the training runs in order, in blocks of bounded size.
void for_each_training_block(const Recording& recording, const LinearStructure& structure,
                             const std::function<void(const Transitions&)>& body);

/// Relative tolerance of the rank of column-scaled regressors (method: section 2).
inline constexpr double excitation_tolerance = 1e-6;

/// X = U basis^+. The rank follows from the singular values of X with columns scaled to unit norm. U spans only the
/// excited directions. Among all coefficients with X beta = U z, beta = basis z has the smallest norm.
struct Decomposition {
  Eigen::MatrixXd U;       ///< N x r; columns are orthonormal
  Eigen::MatrixXd basis;   ///< q x r, X basis = U
  double condition = 0.0;  ///< largest over smallest singular value of the scaled matrix; infinite if the smallest is
                           ///< zero

  Index rank() const { return U.cols(); }
};

/// Decomposes X, which must be finite. Singular values up to `tolerance` times the largest count as zero.
Decomposition decompose(const Eigen::MatrixXd& X, double tolerance);

/// Minimum-norm least-squares coefficients, q x n.
inline Eigen::MatrixXd solve(const Decomposition& d, const Eigen::MatrixXd& Y) {
  return d.basis * (d.U.transpose() * Y);
}

/// Least-squares residuals Y - U U' Y, N x n.
inline Eigen::MatrixXd residuals(const Decomposition& d, const Eigen::MatrixXd& Y) {
  return Y - d.U * (d.U.transpose() * Y);
}

}  // namespace modebank
