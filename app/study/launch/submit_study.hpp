#pragma once

#include <string>

#include "app/study/answers/study_table.hpp"
#include "app/study/study.hpp"

namespace modebank::app {

/// Throws ConfigurationError if PATH has no sbatch, or if a path has characters that Slurm interprets. Call this before
/// any file is written.
void check_submission(const StudyCall& call);

/// Submits an array of tasks, one per ten unfinished runs and at most a hundred, then the merge, and returns the
/// commands as text. The tasks share the runs by claims. `table`: results of the plan's rows so far. Throws the
/// exceptions of submit_to_slurm.
std::string submit_study(const StudyCall& call, const StudyTable& table);

}  // namespace modebank::app
