#include "ident/model/transitions.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

/// Copies samples first .. first + count - 1 of one signal, one sample per row. Samples before the run are NaN.
void copy_signal(const Trajectory::Signals& signals, Index signal, Index first, Index count, double* out) {
  const double* const samples = signals.data() + signal;
  const Index stride = signals.rows(), outside = std::clamp(-first, Index{0}, count);
  std::fill_n(out, outside, not_a_number);
  if (stride == 1) {
    std::copy(samples + first + outside, samples + first + count, out + outside);
  } else {
    for (Index k = outside; k < count; ++k) out[k] = samples[(first + k) * stride];
  }
}

/// Writes transitions start .. start + count - 1 of `run` into the rows from `first` on, column by column.
void fill_rows(const Trajectory& run, Index start, Index count, const LinearStructure& s, Index first,
               Transitions& transitions) {
  const Trajectory::Signals state = run.states(), input = run.inputs();
  const auto column = [first](Eigen::MatrixXd& matrix, Index j) { return matrix.col(j).data() + first; };
  for (Index i = 0; i < s.state_lags; ++i)
    for (Index j = 0; j < s.states; ++j)
      copy_signal(state, j, start - i, count, column(transitions.regressors, i * s.states + j));
  for (Index i = 0; i < s.input_lags; ++i)
    for (Index j = 0; j < s.inputs; ++j)
      copy_signal(input, j, start + 1 - s.input_delay[j] - i, count,
                  column(transitions.regressors, s.dimension() + i * s.inputs + j));
  for (Index j = 0; !s.centre.empty() && j < s.dimension() + s.acting_inputs(); ++j)
    transitions.regressors.col(j).segment(first, count).array() -= s.centre_of(j);
  if (s.intercept) transitions.regressors.col(s.regressors() - 1).segment(first, count).setOnes();
  for (Index j = 0; j < s.states; ++j) {
    double* const increment = column(transitions.increments, j);
    copy_signal(state, j, start + 1, count, increment);
    const double* const samples = state.data() + j;
    for (Index k = 0; k < count; ++k) increment[k] -= samples[(start + k) * state.rows()];
  }
}

Transitions allocate(Index count, const LinearStructure& structure) {
  return {Eigen::MatrixXd(count, structure.regressors()), Eigen::MatrixXd(count, structure.states)};
}

/// Norms of the columns; 1 for a zero column.
Eigen::VectorXd column_scales(const Eigen::MatrixXd& X) {
  Eigen::VectorXd scales(X.cols());
  for (Index j = 0; j < X.cols(); ++j) {
    const double norm = X.col(j).stableNorm();
    scales(j) = norm > 0.0 ? norm : 1.0;
  }
  return scales;
}

/// Ratio of the largest to the smallest of decreasing singular values.
double condition_of(const Eigen::VectorXd& sigma) {
  const Index q = sigma.size();
  return q > 0 && sigma(q - 1) > 0.0 ? sigma(0) / sigma(q - 1) : std::numeric_limits<double>::infinity();
}

/// A fast path for full rank, without singular vectors. Any orthonormal basis of all directions is valid, and
/// Householder's is much cheaper. Empty if the rank is deficient.
std::optional<Decomposition> decompose_full_rank(const Eigen::MatrixXd& scaled, const Eigen::VectorXd& scales,
                                                 double tolerance) {
  const Index q = scaled.cols();
  if (q == 0 || scaled.rows() < q) return std::nullopt;
  ThinQr qr = thin_qr(scaled);
  const Eigen::VectorXd sigma = singular_values(qr.R);
  if (!(sigma(q - 1) > tolerance * sigma(0))) return std::nullopt;
  Decomposition d;
  d.condition = condition_of(sigma);
  d.U = std::move(qr.Q);
  d.basis = divide_by_triangle(scales.cwiseInverse().asDiagonal(), qr.R);
  return d;
}

/// The matrix `basis` with U S V' D basis = U, where D = diag(scales). It lies in the row space of U S V' D.
Eigen::MatrixXd basis_of(const Eigen::VectorXd& scales, const Eigen::MatrixXd& V, const Eigen::VectorXd& sigma) {
  const Index q = V.rows(), rank = V.cols();
  const Eigen::MatrixXd S_inverse = sigma.cwiseInverse().asDiagonal();
  if (rank == q) return scales.cwiseInverse().asDiagonal() * V * S_inverse;
  if (rank == 0) return Eigen::MatrixXd(q, 0);
  // The row space is the span of W = D V. The pseudo-inverse of W' is Q R^-T, which lies in that span.
  const ThinQr qr = thin_qr(scales.asDiagonal() * V);
  return qr.Q * solve_transposed_triangle(qr.R, S_inverse);
}

}  // namespace

Transitions stack_transitions(const Trajectory& run, Index start, Index count, const LinearStructure& structure) {
  Transitions transitions = allocate(count, structure);
  fill_rows(run, start, count, structure, 0, transitions);
  return transitions;
}

void fill_transitions(const Trajectory& run, Index start, Index count, const LinearStructure& structure,
                      Transitions& transitions) {
  fill_rows(run, start, count, structure, 0, transitions);
}

std::vector<Index> usable_rows(const Transitions& transitions) {
  std::vector<Index> rows;
  for (Index k = 0; k < transitions.count(); ++k)
    if (transitions.regressors.row(k).allFinite() && transitions.increments.row(k).allFinite()) rows.push_back(k);
  return rows;
}

Transitions finite_rows(const Transitions& transitions) {
  const std::vector<Index> rows = usable_rows(transitions);
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

void for_each_training_block(const Recording& recording, const LinearStructure& structure,
                             const std::function<void(const Transitions&)>& body) {
  constexpr Index block = 16384;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    for (Index start = 0; start < run.transitions(); start += block) {
      const Transitions t = stack_transitions(run, start, std::min(block, run.transitions() - start), structure);
      body(t.finite() ? t : finite_rows(t));
    }
  }
}

Decomposition decompose(const Eigen::MatrixXd& X, double tolerance) {
  const Eigen::VectorXd scales = column_scales(X);
  const Eigen::MatrixXd scaled = X * scales.cwiseInverse().asDiagonal();
  if (std::optional<Decomposition> full = decompose_full_rank(scaled, scales, tolerance)) return *std::move(full);
  const ThinSvd svd = thin_svd(scaled);
  const Eigen::VectorXd& sigma = svd.sigma;
  Decomposition d;
  d.condition = X.rows() >= X.cols() ? condition_of(sigma) : std::numeric_limits<double>::infinity();
  const Index rank = sigma.size() > 0 ? (sigma.array() > tolerance * sigma(0)).count() : 0;
  d.U = svd.U.leftCols(rank);
  d.basis = basis_of(scales, svd.V.leftCols(rank), sigma.head(rank));
  return d;
}

}  // namespace modebank
