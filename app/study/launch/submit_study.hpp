#pragma once

#include <string>

#include "app/study/space/study_plan.hpp"
#include "app/study/study.hpp"

namespace modebank::app {

/// Throws ConfigurationError, before anything is written, when PATH lacks sbatch or when a path has characters that
/// Slurm interprets.
void check_submission(const StudyCall& call);

/// Submits the shards with unfinished runs, then the merge, and prints the commands. `table`: results of the plan's
/// rows so far. Throws as submit_to_slurm does.
std::string submit_study(const StudyCall& call, const StudyPlan& plan, const StudyTable& table);

}  // namespace modebank::app
