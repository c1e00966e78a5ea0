#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "filter/judge/run/free_run.hpp"

namespace modebank {

/// Options for evaluating a filter. Options of the filter's steps are in FilterOptions.
struct ScoringOptions {
  static inline const std::vector<Eigen::Index> default_horizon{1, 10};
  std::vector<Eigen::Index> horizon = default_horizon;  ///< horizons in samples; the summary already has horizon 1
  FreeRunOptions free_run = {};                         ///< options of free runs, with the seed of the whole chain
  std::uint64_t seed = 1;  ///< seed for the transforms of quantised measurements; the seed of the whole chain
};

}  // namespace modebank
