#include "filter/merging_cost.hpp"

#include <cmath>

#include "ident/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

struct MeanScore {
  double value = not_a_number;
  Index samples = 0;
};

/// Over the samples that have a prediction, as in the summary.
MeanScore mean_log_score(const Bank& bank, const Recording& recording, Role role, const FilterOptions& options) {
  double sum = 0.0;
  Index scored = 0;
  for (const Trajectory& run : recording.runs) {
    if (run.role != role) continue;
    for (const double score : log_densities(bank, run, options)) {
      if (std::isnan(score)) continue;
      sum += score;
      ++scored;
    }
  }
  return {scored > 0 ? sum / static_cast<double>(scored) : not_a_number, scored};
}

}  // namespace

std::vector<MergingCost> merging_costs(const Bank& unlimited, const Bank& limited, Index components,
                                       const Recording& recording, const FilterOptions& options) {
  std::vector<MergingCost> rows;
  for (const Role role : {Role::train, Role::test}) {
    if (recording.transitions(role) == 0) continue;
    const MeanScore before = mean_log_score(unlimited, recording, role, options),
                    after = mean_log_score(limited, recording, role, options);
    rows.push_back({role, components, unlimited.mode_count(), limited.mode_count(), after.samples, before.value,
                    after.value, before.value - after.value});
  }
  return rows;
}

}  // namespace modebank
