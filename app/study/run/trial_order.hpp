#pragma once

#include <vector>

#include "app/study/space/study_plan.hpp"

namespace modebank::app {

/// Planned rows (positions in the table) that share a mixture, those with the same bank next to each other. Groups that
/// share windows follow one another. The order follows from the plan alone.
using TrialGroups = std::vector<std::vector<std::size_t>>;

TrialGroups group_trials(const Config& study, const StudyPlan& plan);

/// The share of one shard: whole groups in turn, or when there are more shards than groups stretches of them.
TrialGroups shard_of(const TrialGroups& groups, std::int64_t index, std::int64_t count);

/// Numbers of different windows, mixtures and banks among trials.
struct DistinctStages {
  std::size_t windows = 0, mixtures = 0, banks = 0;
};
DistinctStages count_stages(const Config& study, const StudyPlan& plan);

}  // namespace modebank::app
