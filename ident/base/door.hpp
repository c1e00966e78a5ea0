#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "modebank/base/error.hpp"
#include "modebank/base/matrix.hpp"

namespace modebank {

/// At an installed door an argument that cannot be used is a ConfigurationError, whoever inside found it.
template <class Call>
auto at_the_door(Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (const std::invalid_argument& error) {
    throw ConfigurationError(error.what());
  }
}

/// Throws std::invalid_argument unless the matrix holds as many numbers as it has elements.
inline void check_filled(const Matrix& matrix, const std::string& name) {
  if (matrix.rows < 0 || matrix.cols < 0 ||
      matrix.rows * matrix.cols != static_cast<std::ptrdiff_t>(matrix.values.size()))
    throw std::invalid_argument(name + " is " + std::to_string(matrix.rows) + " x " + std::to_string(matrix.cols) +
                                " but holds " + std::to_string(matrix.values.size()) + " numbers");
}

}  // namespace modebank
