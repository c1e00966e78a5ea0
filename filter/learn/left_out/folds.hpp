#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// With fewer training runs, runs are cut into stretches, because two folds would train on half of the data.
inline constexpr Eigen::Index fewest_whole_runs = 3;

/// One split of a cross-validation. Both recordings hold training runs only.
struct ValidationSplit {
  Recording training, left_out;
};

/// Splits of the training runs for cross-validation; every run is left out once. More than `most` runs are grouped by
/// length into parts of about equal size. Fewer than fewest_whole_runs are first cut into `most` contiguous stretches
/// each; runs that are too short for that are only trained on. Empty if no run can be left out.
std::vector<ValidationSplit> validation_splits(const Recording& recording, Eigen::Index most);

/// At most `most` transitions of the training runs (0: all), as separate runs. They are contiguous stretches, so that
/// dynamics and stays in a mode are kept. The runs laid end to end are divided into equal shares, and the seed draws
/// one stretch from each. So every run is represented in proportion to its length. A stretch has most / 100
/// transitions, at least 100; shorter runs are taken whole. Empty if the runs have no more: the caller then uses all.
std::optional<Recording> learning_part(const Recording& recording, Eigen::Index most, std::uint64_t seed);

}  // namespace modebank
