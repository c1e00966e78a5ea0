#include <Eigen/QR>
#include <utility>

#include "ident/error.hpp"
#include "ident/fit_window.hpp"
#include "ident/not_a_number.hpp"
#include "ident/regression.hpp"

namespace modebank {

namespace {

/// S (x) (X'X)^-1 for theta row-major; NaN where the transitions leave it open.
Eigen::MatrixXd least_squares_covariance(const Decomposition& d, const Eigen::MatrixXd& residual_square_sum, Index N) {
  const Index q = d.basis.rows(), n = residual_square_sum.rows();
  if (d.rank() < q || N <= q) return Eigen::MatrixXd::Constant(n * q, n * q, not_a_number);
  const Eigen::MatrixXd gram_inverse = d.basis * d.basis.transpose();
  Eigen::MatrixXd covariance(n * q, n * q);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      covariance.block(i * q, j * q, q, q) = residual_square_sum(i, j) / static_cast<double>(N - q) * gram_inverse;
  return covariance;
}

/// All training transitions turned into few rows of the same least-squares problem: the triangle of a QR decomposition
/// that takes block after block (so that a long recording needs no copy of itself), and their count.
std::pair<Transitions, Index> reduce(const Recording& recording, const LinearStructure& structure) {
  const Index q = structure.regressors(), n = structure.states;
  Eigen::MatrixXd triangle(0, q + n);
  Index count = 0;
  for_each_training_block(recording, structure, [&](const Transitions& block) {
    count += block.count();
    Eigen::MatrixXd rows(triangle.rows() + block.count(), q + n);
    rows.topRows(triangle.rows()) = triangle;
    rows.bottomRows(block.count()) << block.regressors, block.increments;
    if (rows.rows() <= q + n) {
      triangle = rows;
      return;
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows);
    triangle = qr.matrixQR().topRows(q + n).triangularView<Eigen::Upper>();
  });
  return {{triangle.leftCols(q), triangle.rightCols(n)}, count};
}

}  // namespace

GlobalModel fit_global(const Recording& recording, const LinearStructure& structure) {
  const auto [transitions, N] = reduce(recording, structure);
  if (N == 0) throw DataError("the training runs hold no transition between two finite samples");
  const Decomposition d = decompose(transitions.regressors, excitation_tolerance);
  const Eigen::MatrixXd coefficients = solve(d, transitions.increments);
  Eigen::MatrixXd square_sum = Eigen::MatrixXd::Zero(structure.states, structure.states);
  for_each_training_block(recording, structure, [&](const Transitions& block) {
    const Eigen::MatrixXd r = block.increments - block.regressors * coefficients;
    square_sum += r.transpose() * r;
  });
  GlobalModel global;
  // Column i of the coefficients is row i of [A B c], so their column-major vec is theta.
  global.theta = coefficients.reshaped();
  global.covariance = least_squares_covariance(d, square_sum, N);
  global.residual_covariance = square_sum / static_cast<double>(N);
  global.transitions = N;
  return global;
}

}  // namespace modebank
