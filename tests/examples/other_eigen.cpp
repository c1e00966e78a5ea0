#include "other_eigen.hpp"

#include <Eigen/Dense>

double other_eigen_sum() {
  double sum = 0.0;
  for (int size = 1; size < 40; ++size) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Constant(size, size, 0.5);
    matrix.conservativeResize(size, size + 1);
    matrix.col(size).setOnes();
    sum += (matrix * matrix.transpose()).trace();
  }
  return sum;
}
