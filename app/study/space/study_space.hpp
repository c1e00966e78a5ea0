#pragma once

#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/config/vary_text.hpp"

namespace modebank::app {

/// One configuration of a study, as the texts of all varied keys in the order of study.vary.
using StudyPoint = std::vector<std::string>;

struct StudySpace {
  std::vector<std::string> keys;   ///< varied keys, in the order of study.vary
  std::vector<StudyPoint> points;  ///< distinct points; in a grid, the last key changes fastest
  std::size_t repeated = 0;        ///< number of points that were dropped because they equal an earlier one
};

/// Every point of the grid, or study.sample points of a Latin hypercube (McKay, Beckman & Conover 1979). The seed is
/// job.seed. Throws ConfigurationError if lines contradict each other.
StudySpace lay_out(const Config& config);

}  // namespace modebank::app
