#include "filter/definite_inverse.hpp"

#include <Eigen/Cholesky>

namespace modebank {

Eigen::MatrixXd definite_inverse(const Eigen::MatrixXd& matrix) {
  return matrix.llt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

}  // namespace modebank
