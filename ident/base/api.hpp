#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "modebank/base/error.hpp"
#include "modebank/base/matrix.hpp"

namespace modebank {

/// Converts every rejected argument into std::invalid_argument, the exception of the public API.
template <class Call>
auto api_call(Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (const ConfigurationError& error) {
    throw std::invalid_argument(error.what());
  }
}

/// Throws std::invalid_argument if the number of stored values differs from the number of elements.
inline void check_filled(const Matrix& matrix, const std::string& name) {
  if (matrix.rows < 0 || matrix.cols < 0 ||
      matrix.rows * matrix.cols != static_cast<std::ptrdiff_t>(matrix.values.size()))
    throw std::invalid_argument(name + " is " + std::to_string(matrix.rows) + " x " + std::to_string(matrix.cols) +
                                " but holds " + std::to_string(matrix.values.size()) + " numbers");
}

}  // namespace modebank
