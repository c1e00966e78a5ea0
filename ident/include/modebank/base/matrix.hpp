#pragma once

#include <cstddef>
#include <initializer_list>
#include <vector>

namespace modebank {

/// A column-major matrix of doubles, the type of the library's public API. It holds only a std::vector. So the library
/// and a program can exchange matrices even if they are compiled with different settings. modebank/base/eigen.hpp gives
/// Eigen views without a copy.
struct Matrix {
  std::ptrdiff_t rows = 0;     ///< number of rows
  std::ptrdiff_t cols = 0;     ///< number of columns
  std::vector<double> values;  ///< rows * cols numbers, column by column

  /// An empty matrix.
  Matrix() = default;
  /// A matrix of the given size with every element `value`.
  Matrix(std::ptrdiff_t row_count, std::ptrdiff_t column_count, double value = 0.0)
      : rows(row_count), cols(column_count), values(static_cast<std::size_t>(row_count * column_count), value) {}
  /// Elements row by row: {{a, b}, {c, d}}. Shorter rows are filled with zeros.
  Matrix(std::initializer_list<std::initializer_list<double>> rows_of_numbers) {
    for (const auto& row : rows_of_numbers)
      if (static_cast<std::ptrdiff_t>(row.size()) > cols) cols = static_cast<std::ptrdiff_t>(row.size());
    rows = static_cast<std::ptrdiff_t>(rows_of_numbers.size());
    values.assign(static_cast<std::size_t>(rows * cols), 0.0);
    std::ptrdiff_t i = 0;
    for (const auto& row : rows_of_numbers) {
      std::ptrdiff_t j = 0;
      for (const double number : row) (*this)(i, j++) = number;
      ++i;
    }
  }

  /// Element in row i and column j, both from 0; not checked.
  double& operator()(std::ptrdiff_t i, std::ptrdiff_t j) { return values[static_cast<std::size_t>(j * rows + i)]; }
  /// Element in row i and column j, both from 0; not checked.
  double operator()(std::ptrdiff_t i, std::ptrdiff_t j) const { return values[static_cast<std::size_t>(j * rows + i)]; }
};

}  // namespace modebank
