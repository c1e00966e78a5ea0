#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// What one line of study.vary says: a key's values, or a range that `sample` draws from.
struct VariedKey {
  std::string key;
  std::vector<std::string> values;  ///< expanded; empty for a range
  double low = 0.0, high = 0.0;     ///< of the range
  bool logarithmic = false;

  bool is_range() const { return values.empty(); }
};

/// What one line of study.when says: `key` is varied only where `other` has one of `values`.
struct VaryCondition {
  std::string key, other;
  std::vector<std::string> values;
};

/// Take one line apart and check its keys and values, which come back in the form that a resolved configuration has.
/// Throw std::invalid_argument with the reason.
VariedKey parse_vary(const std::string& line);
std::vector<std::string> parse_together(const std::string& line);
VaryCondition parse_when(const std::string& line);

}  // namespace modebank::app
