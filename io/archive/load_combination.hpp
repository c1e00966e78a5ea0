#pragma once

#include <vector>

#include "filter/judge/combination.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// Weights of an archive's filters in the combined forecasts. Empty if no filters were combined. The other parts of the
/// file are not decoded. Throws the same exceptions as load_bank.
std::vector<CombinationRow> load_combination(const OpenArchive& archive);

}  // namespace modebank
