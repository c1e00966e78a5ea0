#pragma once

#include <string>

#include "app/study/run/study_estimate.hpp"

namespace modebank::app {

/// Numbers of runs, what was dropped and why, what runs share.
std::string plan_text(const StudyPlan& plan, const DistinctStages& distinct, std::int64_t repeats);
std::string estimate_text(const StudyEstimate& estimate, const TrialStore& store, std::size_t jobs);
/// Counts by status, then every failed and missing run.
std::string table_text(const StudyTable& table, const TrialStore& store);

}  // namespace modebank::app
