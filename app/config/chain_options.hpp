#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "filter/learn/chain/options.hpp"
#include "io/import/options.hpp"

namespace modebank {

/// Everything that decides the numbers of a chain beside its data.
struct ChainOptions : LearningOptions {
  DataOptions data = {};
  std::vector<std::string> mode_names = {};  ///< of the bank; they change no number
};

/// Refinement's starts from random stretches of runs: three for every ten restarts of the mixture.
inline std::ptrdiff_t refinement_restarts(int restarts) { return std::lround(0.3 * restarts); }

}  // namespace modebank
