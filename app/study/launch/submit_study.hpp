#pragma once

#include <string>

#include "app/study/space/study_plan.hpp"
#include "app/study/study.hpp"

namespace modebank::app {

/// Throws ConfigurationError if PATH has no sbatch, or if a path has characters that Slurm interprets. Call this before
/// any file is written.
void check_submission(const StudyCall& call);

/// Submits the shards that have unfinished runs, then the merge, and prints the commands. `table`: results of the
/// plan's rows so far. Throws the exceptions of submit_to_slurm.
std::string submit_study(const StudyCall& call, const StudyPlan& plan, const StudyTable& table);

}  // namespace modebank::app
