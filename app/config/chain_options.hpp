#pragma once

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

}  // namespace modebank
