#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// One line of study.vary: a key with its values, or with a range that `sample` draws from.
struct VariedKey {
  std::string key;
  std::vector<std::string> values;  ///< expanded; empty for a range
  double low = 0.0, high = 0.0;     ///< bounds of the range
  bool logarithmic = false;

  bool is_range() const { return values.empty(); }
};

/// One line of study.when: `key` is varied only where `other` has one of `values`.
struct VaryCondition {
  std::string key, other;
  std::vector<std::string> values;
};

/// Parse one line and check its keys and values, which are returned in the form of a resolved configuration. Throw
/// std::invalid_argument with the reason.
VariedKey parse_vary(const std::string& line);
std::vector<std::string> parse_together(const std::string& line);
VaryCondition parse_when(const std::string& line);

}  // namespace modebank::app
