#pragma once

#include <vector>

#include "filter/judge/score/combination.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// How much each filter of an archive counted in their combined forecasts; none where nothing was combined. Nothing
/// else of the file is decoded. Throws as load_bank does.
std::vector<CombinationRow> load_combination(const OpenArchive& archive);

}  // namespace modebank
