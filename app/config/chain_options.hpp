#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "filter/learn/chain/inputs.hpp"
#include "io/import/options.hpp"

namespace modebank {

/// The options of every stage. Together with the data they determine all numbers of a chain.
struct ChainOptions : LearningOptions {
  DataOptions data = {};
  std::vector<std::string> mode_names = {};  ///< names of the bank's modes; they affect no number
};

/// Number of refinement's starts from random parts of runs: three for every ten restarts of the mixture.
inline std::ptrdiff_t refinement_restarts(int restarts) { return std::lround(0.3 * restarts); }

}  // namespace modebank
