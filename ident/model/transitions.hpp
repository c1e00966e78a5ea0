#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// N transitions as a linear regression, increments = regressors [A B c]' + noise. Once finite_rows has applied the
/// sample weights, each row is multiplied by the root of its weight, so that least squares on the rows is the weighted
/// one.
struct Transitions {
  Eigen::MatrixXd regressors;   ///< N x q, row k is phi_k' = [z[k]' v[k]' (1)]
  Eigen::MatrixXd increments;   ///< N x n, row k is (x[k+1] - x[k])'
  Eigen::VectorXd weight = {};  ///< N sample weights, or empty: all one

  Index count() const { return regressors.rows(); }
  bool finite() const { return regressors.allFinite() && increments.allFinite(); }
};

/// The rows that finite_rows takes.
std::vector<Eigen::Index> usable_rows(const Transitions& transitions);

/// Transitions start .. start + count - 1 of a run, rows not yet multiplied by anything; NaN where a lagged sample lies
/// before the run. Throws std::invalid_argument for weights that are not one per sample, negative or not finite.
Transitions stack_transitions(const Trajectory& run, Index start, Index count, const LinearStructure& structure);
/// The same into the first `count` rows of transitions that are large enough; allocates nothing.
void fill_transitions(const Trajectory& run, Index start, Index count, const LinearStructure& structure,
                      Transitions& transitions);
/// finite_rows of all transitions of the training runs.
Transitions stack_training(const Recording& recording, const LinearStructure& structure);
/// The rows whose entries are all finite and whose weight is not zero; weights are divided by their mean over these
/// rows (to a mean of one, so that L transitions count as L) and applied to the rows.
Transitions finite_rows(const Transitions& transitions);
/// Takes the weights back out of rows to which finite_rows has applied them.
Transitions unweighted(const Transitions& transitions);

/// Runs over the same transitions in blocks of bounded size, in order; weighted ones come in one block.
void for_each_training_block(const Recording& recording, const LinearStructure& structure,
                             const std::function<void(const Transitions&)>& body);

/// Relative tolerance of a rank decision on the column-scaled regressors (method: section 2).
inline constexpr double excitation_tolerance = 1e-6;

/// X = U basis^+, its rank by the singular values of X with its columns scaled to unit norm. U spans the excited
/// directions only, and coefficients beta = basis z in them have the smallest norm among all that give X beta = U z.
struct Decomposition {
  Eigen::MatrixXd U;       ///< N x r, orthonormal columns
  Eigen::MatrixXd basis;   ///< q x r, X basis = U
  double condition = 0.0;  ///< largest over smallest singular value of the scaled matrix; infinite when that is zero

  Index rank() const { return U.cols(); }
};

/// Singular values at or below `tolerance` times the largest count as zero. X must be finite.
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
