#pragma once

#include <vector>

#include "app/study/space/study_plan.hpp"

namespace modebank::app {

/// Groups of planned rows (indices in the table). The rows of a group share a mixture. Rows with the same bank are
/// neighbours, and groups that share windows are also neighbours. The order depends only on the plan.
using TrialGroups = std::vector<std::vector<std::size_t>>;

TrialGroups group_trials(const Config& study, const StudyPlan& plan);

}  // namespace modebank::app
