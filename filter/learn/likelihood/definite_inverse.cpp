#include "filter/learn/likelihood/definite_inverse.hpp"

#include <Eigen/Cholesky>

#include "ident/base/not_a_number.hpp"

namespace modebank {

Eigen::MatrixXd definite_inverse(const Eigen::MatrixXd& matrix) {
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  // The factorisation stops at the pivot that fails, and would solve with what it has.
  if (factor.info() != Eigen::Success) return Eigen::MatrixXd::Constant(matrix.rows(), matrix.cols(), not_a_number);
  return factor.solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

}  // namespace modebank
