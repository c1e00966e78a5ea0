#pragma once

#include <vector>

#include "filter/judge/score/combination.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// Weights of an archive's filters in their combined forecasts; empty where nothing was combined. Decodes nothing else
/// of the file. Throws as load_bank does.
std::vector<CombinationRow> load_combination(const OpenArchive& archive);

}  // namespace modebank
