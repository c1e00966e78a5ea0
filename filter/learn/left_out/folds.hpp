#pragma once

#include <vector>

#include "filter/learn/tuning.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// One split of a cross-validation. Both recordings hold training runs only.
struct ValidationSplit {
  Recording training;
  Recording left_out;
};

/// Index of the part with which each run is left out. The longest runs are assigned first, each to the part that is
/// shortest so far.
std::vector<Index> deal_by_length(const std::vector<Index>& lengths, Index parts);

/// Splits of the training runs for cross-validation. Every run is left out once.
/// - More than `most` runs are grouped by length into parts of about equal size; the runs of a part are left out
///   together.
/// - Fewer than three runs are first cut into `most` contiguous stretches each. Runs that are too short for that are
///   only trained on.
/// Empty if no run can be left out. Held-out runs are never used.
std::vector<ValidationSplit> validation_splits(const Recording& recording, Index most, const RefineTuning& tuning = {});

}  // namespace modebank
