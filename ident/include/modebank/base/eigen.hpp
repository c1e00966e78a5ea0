#pragma once

#include <Eigen/Core>
#include <vector>

#include "modebank/base/matrix.hpp"

namespace modebank {

// Functions of a template, so that what a program compiles of them is its own, whatever its Eigen is called and aligned
// to.

/// The matrix as Eigen sees it, unaligned and without a copy; valid while `matrix` lives and keeps its size.
template <int = 0>
Eigen::Map<const Eigen::MatrixXd> view(const Matrix& matrix) {
  return {matrix.values.data(), matrix.rows, matrix.cols};
}

/// The numbers as a column vector of Eigen's, unaligned and without a copy.
template <int = 0>
Eigen::Map<const Eigen::VectorXd> view(const std::vector<double>& vector) {
  return {vector.data(), static_cast<Eigen::Index>(vector.size())};
}

/// A copy of anything that Eigen can evaluate.
template <class Derived>
Matrix to_matrix(const Eigen::DenseBase<Derived>& source) {
  Matrix result(source.rows(), source.cols());
  Eigen::Map<Eigen::MatrixXd>(result.values.data(), source.rows(), source.cols()) = source;
  return result;
}

/// A copy of a vector of Eigen's.
template <class Derived>
std::vector<double> to_vector(const Eigen::DenseBase<Derived>& source) {
  std::vector<double> result(static_cast<std::size_t>(source.size()));
  Eigen::Map<Eigen::VectorXd>(result.data(), source.size()) = source;
  return result;
}

}  // namespace modebank
