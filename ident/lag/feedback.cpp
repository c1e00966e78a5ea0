#include "ident/lag/feedback.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index state_lags = 3, input_lags = 5;
constexpr Index most_rows = 50000;  // more rows would increase the t values without changing the decision

/// Pairs of successive finite transitions: the inputs of the later transition, and the innovations of both transitions.
struct InputRows {
  MatrixXd older;       ///< N x (input lags before the newest, and a constant)
  MatrixXd newest;      ///< N x m
  MatrixXd past, same;  ///< N x n, innovations of the previous transition and of the same transition
};

struct Regressors {
  MatrixXd predictors, increments, inputs;
  std::vector<bool> follows;  ///< whether a row follows the previous one without a gap
};

Regressors stack(const Recording& recording, const LinearStructure& structure) {
  const Index n = structure.dimension(), m = structure.inputs;
  std::vector<Transitions> runs;
  std::vector<std::vector<Index>> kept;
  Index rows = 0;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train || run.transitions() == 0) continue;
    const Index count = std::min(run.transitions(), most_rows - rows);
    if (count <= 0) break;
    runs.push_back(stack_transitions(run, 0, count, structure));
    kept.emplace_back();
    for (Index k = 0; k < count; ++k)
      if (runs.back().regressors.row(k).allFinite() && runs.back().increments.row(k).allFinite())
        kept.back().push_back(k);
    rows += std::ssize(kept.back());
  }
  Regressors all{MatrixXd(rows, structure.regressors() - m),
                 MatrixXd(rows, structure.states),
                 MatrixXd(rows, structure.acting_inputs()),
                 {}};
  Index first = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::vector<Index>& of_run = kept[r];
    const MatrixXd regressors = runs[r].regressors(of_run, Eigen::all);
    const auto count = std::ssize(of_run);
    all.predictors.middleRows(first, count) << regressors.leftCols(n),
        regressors.middleCols(n + m, structure.acting_inputs() - m), VectorXd::Ones(count);
    all.inputs.middleRows(first, count) = regressors.middleCols(n, structure.acting_inputs());
    all.increments.middleRows(first, count) = runs[r].increments(of_run, Eigen::all);
    for (std::size_t i = 0; i < of_run.size(); ++i) all.follows.push_back(i > 0 && of_run[i] == of_run[i - 1] + 1);
    first += count;
  }
  return all;
}

InputRows input_rows(const Recording& recording, const LinearStructure& structure) {
  const Regressors all = stack(recording, structure);
  if (all.predictors.rows() == 0) return {};
  const MatrixXd innovations = residuals(decompose(all.predictors, excitation_tolerance), all.increments);
  std::vector<Index> later, earlier;
  for (Index k = 1; k < all.predictors.rows(); ++k)
    if (all.follows[static_cast<std::size_t>(k)]) {
      later.push_back(k);
      earlier.push_back(k - 1);
    }
  const Index m = structure.inputs, older = all.inputs.cols() - m;
  InputRows rows{MatrixXd::Ones(std::ssize(later), older + 1), all.inputs(later, Eigen::all).leftCols(m),
                 innovations(earlier, Eigen::all), innovations(later, Eigen::all)};
  rows.older.leftCols(older) = all.inputs(later, Eigen::all).rightCols(older);
  return rows;
}

/// Largest |t| among columns from + 0 .. from + n - 1 in a regression of y on Z. Only the last `count` columns have t
/// values.
double largest_t(const MatrixXd& Z, const Decomposition& d, const VectorXd& y, Index from, Index n) {
  const MatrixXd coefficients = solve(d, y);
  const VectorXd r = residuals(d, y);
  const auto freedom = static_cast<double>(Z.rows() - d.rank());
  const MatrixXd by_row = d.basis * d.U.transpose();  // q x N; this matrix times y gives the coefficients
  double largest = 0.0;
  for (Index j = from; j < from + n; ++j) {
    const double constant = by_row.row(j).squaredNorm() * r.squaredNorm() / freedom;
    const double white = by_row.row(j).cwiseProduct(r.transpose()).squaredNorm();
    const double variance = std::max(constant, white);
    if (variance > 0.0) largest = std::max(largest, std::abs(coefficients(j, 0)) / std::sqrt(variance));
  }
  return largest;
}

}  // namespace

InputFeedback input_feedback(const Recording& recording) {
  const LinearStructure structure{recording.state_count(), recording.input_count(), true, state_lags, input_lags, 0};
  const InputFeedback unknown{not_a_number, not_a_number};
  if (structure.inputs == 0) return unknown;
  const InputRows rows = input_rows(recording, structure);
  const Index n = structure.states, own = rows.older.cols(), q = own + 2 * n;
  if (rows.older.rows() < 2 * std::max(q, structure.regressors())) return unknown;
  MatrixXd Z(rows.older.rows(), q);
  Z << rows.older, rows.past, rows.same;
  const Decomposition d = decompose(Z, excitation_tolerance);
  InputFeedback feedback;
  for (Index j = 0; j < structure.inputs; ++j) {
    const VectorXd y = rows.newest.col(j);
    feedback.past_t = std::max(feedback.past_t, largest_t(Z, d, y, own, n));
    feedback.same_sample_t = std::max(feedback.same_sample_t, largest_t(Z, d, y, own + n, n));
  }
  return feedback;
}

}  // namespace modebank
