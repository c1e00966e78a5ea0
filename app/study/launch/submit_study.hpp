#pragma once

#include <string>

#include "app/study/space/study_plan.hpp"
#include "app/study/study.hpp"

namespace modebank::app {

/// Refuses what no job could take, before anything is written: throws ConfigurationError when there is no sbatch, or
/// when a path holds what Slurm would take for something else.
void check_submission(const StudyCall& call);

/// Hands to Slurm the shards that still have runs to do, then the merge; says what was typed for it. `table`: what
/// became of the plan's rows so far. Throws as submit_to_slurm does.
std::string submit_study(const StudyCall& call, const StudyPlan& plan, const StudyTable& table);

}  // namespace modebank::app
