#pragma once

#include <vector>

#include "filter/judge/score/combination.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// Weights of an archive's filters in their combined forecasts; empty if no filters were combined. The other parts of
/// the file are not decoded. Throws as load_bank does.
std::vector<CombinationRow> load_combination(const OpenArchive& archive);

}  // namespace modebank
