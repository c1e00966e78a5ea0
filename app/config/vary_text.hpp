#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// One line of study.vary: a key with its values, or with a range. `sample` draws values from a range.
struct VariedKey {
  std::string key;
  std::vector<std::string> values;  ///< all values; empty for a range
  double low = 0.0, high = 0.0;     ///< bounds of the range
  bool logarithmic = false;

  bool is_range() const { return values.empty(); }
};

/// Each parses one line, and checks its keys and values. The returned values have the form of a resolved configuration.
/// Throws std::invalid_argument with the reason.
VariedKey parse_vary(const std::string& line);
std::vector<std::string> parse_together(const std::string& line);

}  // namespace modebank::app
