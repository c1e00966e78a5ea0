#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// What a limit on the number of modes cost on the runs of one role: a row of /bank/merged.
struct MergingCost {
  Role role = Role::train;
  Eigen::Index components = 0;       ///< of the mixture, before the closest ones were merged
  Eigen::Index modes_unlimited = 0;  ///< of the bank learned without the limit
  Eigen::Index modes = 0;            ///< of the bank learned with it
  Eigen::Index samples = 0;          ///< scored
  double log_score_unlimited = 0.0;  ///< mean log predictive density [nats/sample]
  double log_score = 0.0;
  double loss = 0.0;  ///< of log score by the limit; negative where the bank is better with it
};

/// One row per role that has runs. `components`: of the mixture that both banks were learned from.
std::vector<MergingCost> merging_costs(const Bank& unlimited, const Bank& limited, Eigen::Index components,
                                       const Recording& recording, const FilterOptions& options);

}  // namespace modebank
