#pragma once

#include <string>
#include <vector>

#include "app/config.hpp"

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

/// One configuration of a study: the text of every varied key, in the order of study.vary.
using StudyPoint = std::vector<std::string>;

struct StudySpace {
  std::vector<std::string> keys;   ///< varied keys, in the order of study.vary
  std::vector<StudyPoint> points;  ///< distinct; grid: the last key changes fastest
  std::size_t repeated = 0;        ///< points left out because they say the same as an earlier one
};

/// Every point of the grid, or study.sample points: Latin hypercube (McKay, Beckman & Conover 1979) or Sobol's sequence
/// (Joe & Kuo's directions, by Boost.Random) with a random digital shift; both seeded by job.seed. A key whose
/// condition does not hold takes the configuration's own value. Throws ConfigurationError where lines contradict each
/// other.
StudySpace lay_out(const Config& config);

}  // namespace modebank::app
