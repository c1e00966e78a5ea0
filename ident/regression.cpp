#include "ident/regression.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <limits>
#include <vector>

namespace modebank {

namespace {

/// Writes transitions start .. start + count - 1 of `run` to the rows from `first` on.
void fill_rows(const Trajectory& run, Index start, Index count, const LinearStructure& structure, Index first,
               Transitions& transitions) {
  for (Index k = 0; k < count; ++k) {
    fill_regressor(structure, run.state.col(start + k), run.input.col(start + k),
                   transitions.regressors.row(first + k).transpose());
    transitions.increments.row(first + k) = (run.state.col(start + k + 1) - run.state.col(start + k)).transpose();
  }
}

Transitions allocate(Index count, const LinearStructure& structure) {
  return {Eigen::MatrixXd(count, structure.regressors()), Eigen::MatrixXd(count, structure.states)};
}

/// Norms of the columns; 1 for a zero column, which stays zero.
Eigen::VectorXd column_scales(const Eigen::MatrixXd& X) {
  Eigen::VectorXd scales(X.cols());
  for (Index j = 0; j < X.cols(); ++j) {
    const double norm = X.col(j).stableNorm();
    scales(j) = norm > 0.0 ? norm : 1.0;
  }
  return scales;
}

/// basis with U S V' D basis = U, D = diag(scales), in the row space of U S V' D.
Eigen::MatrixXd basis_of(const Eigen::VectorXd& scales, const Eigen::MatrixXd& V, const Eigen::VectorXd& sigma) {
  const Index q = V.rows(), rank = V.cols();
  const Eigen::MatrixXd S_inverse = sigma.cwiseInverse().asDiagonal();
  if (rank == q) return scales.cwiseInverse().asDiagonal() * V * S_inverse;
  Eigen::MatrixXd basis(q, rank);
  if (rank == 0) return basis;
  // The row space is the span of W = D V; the pseudo-inverse of W' is Q R^-T, which stays in it.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(scales.asDiagonal() * V);
  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(q, rank);
  const Eigen::MatrixXd R = qr.matrixQR().topRows(rank).triangularView<Eigen::Upper>();
  basis = Q * R.transpose().triangularView<Eigen::Lower>().solve(S_inverse);
  return basis;
}

}  // namespace

Transitions stack_transitions(const Trajectory& run, Index start, Index count, const LinearStructure& structure) {
  Transitions transitions = allocate(count, structure);
  fill_rows(run, start, count, structure, 0, transitions);
  return transitions;
}

Transitions finite_rows(const Transitions& transitions) {
  std::vector<Index> rows;
  for (Index k = 0; k < transitions.count(); ++k)
    if (transitions.regressors.row(k).allFinite() && transitions.increments.row(k).allFinite()) rows.push_back(k);
  return {transitions.regressors(rows, Eigen::all), transitions.increments(rows, Eigen::all)};
}

Transitions stack_training(const Recording& recording, const LinearStructure& structure) {
  Transitions all = allocate(recording.transitions(Role::train), structure);
  Index first = 0;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    fill_rows(run, 0, run.transitions(), structure, first, all);
    first += run.transitions();
  }
  return all.finite() ? all : finite_rows(all);
}

Decomposition decompose(const Eigen::MatrixXd& X, double tolerance) {
  const Eigen::VectorXd scales = column_scales(X);
  const Eigen::MatrixXd scaled = X * scales.cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& sigma = svd.singularValues();  // decreasing
  const double largest = sigma.size() > 0 ? sigma(0) : 0.0;
  const bool all_columns = X.rows() >= X.cols() && X.cols() > 0 && sigma(X.cols() - 1) > 0.0;

  Decomposition d;
  d.condition = all_columns ? largest / sigma(X.cols() - 1) : std::numeric_limits<double>::infinity();
  const Index rank = (sigma.array() > tolerance * largest).count();
  d.U = svd.matrixU().leftCols(rank);
  d.basis = basis_of(scales, svd.matrixV().leftCols(rank), sigma.head(rank));
  return d;
}

}  // namespace modebank
