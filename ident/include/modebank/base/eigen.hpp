#pragma once

#include <Eigen/Core>
#include <vector>

#include "modebank/base/matrix.hpp"

namespace modebank {

// Conversions are templates, so each program compiles them with its own version and alignment of Eigen.

/// View of the matrix for Eigen, unaligned and without a copy; valid while `matrix` lives and keeps its size.
template <int = 0>
Eigen::Map<const Eigen::MatrixXd> view(const Matrix& matrix) {
  return {matrix.values.data(), matrix.rows, matrix.cols};
}

/// View of the numbers as an Eigen column vector, unaligned and without a copy.
template <int = 0>
Eigen::Map<const Eigen::VectorXd> view(const std::vector<double>& vector) {
  return {vector.data(), static_cast<Eigen::Index>(vector.size())};
}

/// Copies any Eigen expression.
template <class Derived>
Matrix to_matrix(const Eigen::DenseBase<Derived>& source) {
  Matrix result(source.rows(), source.cols());
  Eigen::Map<Eigen::MatrixXd>(result.values.data(), source.rows(), source.cols()) = source;
  return result;
}

/// Copies an Eigen vector.
template <class Derived>
std::vector<double> to_vector(const Eigen::DenseBase<Derived>& source) {
  std::vector<double> result(static_cast<std::size_t>(source.size()));
  Eigen::Map<Eigen::VectorXd>(result.data(), source.size()) = source;
  return result;
}

}  // namespace modebank
