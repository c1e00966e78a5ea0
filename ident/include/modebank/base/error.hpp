#pragma once

#include <stdexcept>

namespace modebank {

/// An error in what the user typed or configured; the program exits with status 2. Functions of the C++ library throw
/// std::invalid_argument instead.
struct ConfigurationError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file's content, or the data as a whole, cannot be used. The program exits with status 1.
struct DataError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace modebank
