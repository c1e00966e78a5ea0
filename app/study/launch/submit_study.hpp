#pragma once

#include <string>

#include "app/command_line.hpp"
#include "app/study/study_plan.hpp"

namespace modebank::app {

/// Hands to Slurm the shards that still have runs to do, then the merge; says what was typed for it. `table`: what
/// became of the plan's rows so far. Throws as submit_to_slurm does.
std::string submit_study(const CommandLine& line, const Config& config, const StudyPlan& plan, const StudyTable& table);

}  // namespace modebank::app
