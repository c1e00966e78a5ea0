#pragma once

#include <vector>

#include "filter/judge/run/free_run.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Free runs of every run, side by side; none where none is asked for (options.samples = 0). Throw what free_run
/// throws.
std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options);

}  // namespace modebank
