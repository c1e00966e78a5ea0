#pragma once

#include <stdexcept>

namespace modebank {

/// A mistake of the program's user; exit status 2. Functions of the C++ library throw std::invalid_argument instead.
struct ConfigurationError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The content of a file, or of the data as a whole, cannot be used. The program ends with exit status 1.
struct DataError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace modebank
