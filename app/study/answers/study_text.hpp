#pragma once

#include <string>

#include "app/study/run/trial_order.hpp"
#include "app/study/run/trial_store.hpp"

namespace modebank::app {

/// Text with the number of runs, and the dropped points with reasons.
std::string plan_text(const StudyPlan& plan, std::int64_t repeats);
/// Number of runs by status, then every failed and every missing run.
std::string table_text(const StudyTable& table, const TrialStore& store);

}  // namespace modebank::app
