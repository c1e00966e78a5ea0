#pragma once

#include <stdexcept>

namespace modebank {

/// The caller's mistake, found before any sample is read: usage, key, value, path, column, run name. Exit status 2.
struct ConfigurationError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The content of a file, or of the data as a whole, cannot be used. Exit status 1.
struct DataError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace modebank
