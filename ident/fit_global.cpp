
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

}  // namespace

GlobalModel fit_global(const Recording& recording, const LinearStructure& structure) {
  const Transitions transitions = stack_training(recording, structure);
  const Index N = transitions.count();
  if (N == 0) throw DataError("the training runs hold no transition between two finite samples");
  const Decomposition d = decompose(transitions.regressors, excitation_tolerance);
  const Eigen::MatrixXd r = residuals(d, transitions.increments);
  const Eigen::MatrixXd square_sum = r.transpose() * r;
  GlobalModel global;
  // Column i of the coefficients is row i of [A B c], so their column-major vec is theta.
  global.theta = solve(d, transitions.increments).reshaped();
  global.covariance = least_squares_covariance(d, square_sum, N);
  global.residual_covariance = square_sum / static_cast<double>(N);
  global.transitions = N;
  return global;
}

}  // namespace modebank
