#pragma once

#include <vector>

#include "filter/judge/run/free_run.hpp"
#include "filter/step/bank.hpp"
#include "filter/step/drifting.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Free runs of every run, side by side; none where none is asked for (options.samples = 0). Throw what free_run
/// throws.
std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options);
std::vector<FreeRun> free_runs(const DriftingModel& model, const std::vector<Trajectory>& runs,
                               const FreeRunOptions& options);

}  // namespace modebank
