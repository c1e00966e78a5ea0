#pragma once

#include <vector>

#include "filter/judge/run/free_run.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Free runs of all runs, in parallel; empty if none is requested (options.samples = 0). Throws what free_run throws.
std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options);

}  // namespace modebank
