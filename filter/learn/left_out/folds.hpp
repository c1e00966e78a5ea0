#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "filter/learn/tuning.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// One split of a cross-validation. Both recordings hold training runs only.
struct ValidationSplit {
  Recording training;
  Recording left_out;
};

/// Splits of the training runs for cross-validation. Every run is left out once.
/// - More than `most` runs are grouped by length into parts of about equal size; the runs of a part are left out
///   together.
/// - Fewer than three runs are first cut into `most` contiguous stretches each. Runs that are too short for that are
///   only trained on.
/// Empty if no run can be left out. Held-out runs are never used.
std::vector<ValidationSplit> validation_splits(const Recording& recording, Index most);

/// A part of the training runs for learning, as separate runs. `most`: largest number of transitions; 0 takes all. It
/// consists of whole contiguous stretches, so that dynamics and stays in a mode are kept. The runs laid end to end are
/// divided into equal shares, and the seed draws one stretch from each share. So every run is represented in proportion
/// to its length. A stretch has most / 100 transitions, at least 100; shorter runs are taken whole. The draw depends on
/// the runs, `most` and the seed alone. If the runs have no more transitions than `most`, the result is empty, and the
/// caller uses all runs. Held-out runs are excluded.
std::optional<Recording> learning_part(const Recording& recording, Eigen::Index most, std::uint64_t seed);

}  // namespace modebank
