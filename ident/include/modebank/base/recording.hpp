#pragma once

#include <string>
#include <vector>

#include "modebank/base/matrix.hpp"

namespace modebank {

/// One recorded run of N samples; column k of a signal is sample k.
struct RecordedRun {
  std::string name;            ///< of the run
  bool held_out = false;       ///< true: scored, never learned from
  std::vector<double> time_s;  ///< N, strictly increasing
  Matrix state;                ///< n x N, as measured; NaN where missing
  Matrix input;                ///< m x N
  std::vector<double> weight;  ///< N or empty (all one): of the transition that ends in sample k, >= 0
};

}  // namespace modebank
