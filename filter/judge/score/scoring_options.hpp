#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "filter/judge/run/free_run.hpp"

namespace modebank {

/// What is found out about a filter, beside how it steps.
struct ScoringOptions {
  static inline const std::vector<Eigen::Index> default_horizon{1, 10};
  std::vector<Eigen::Index> horizon = default_horizon;  ///< samples ahead; 1 alone is what the summary scores anyway
  bool smooth = true;            ///< smoothed states and the most probable sequence of modes, too
  FreeRunOptions free_run = {};  ///< its seed is the chain's
  std::uint64_t seed = 1;        ///< of the transforms of quantised measurements; the chain's
};

}  // namespace modebank
