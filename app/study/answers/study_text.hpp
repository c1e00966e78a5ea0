#pragma once

#include <string>

#include "app/study/run/trial_order.hpp"
#include "app/study/run/trial_store.hpp"

namespace modebank::app {

/// Numbers of runs, dropped points with the reasons, and stages that runs share.
std::string plan_text(const StudyPlan& plan, const DistinctStages& distinct, std::int64_t repeats);
/// Counts by status, then every failed and missing run.
std::string table_text(const StudyTable& table, const TrialStore& store);

}  // namespace modebank::app
