#pragma once

#include <vector>

#include "filter/judge/run/free_run.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Free runs of all runs, in parallel; empty if free runs are off (options.samples = 0). Throws the errors of free_run.
std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options);

}  // namespace modebank
