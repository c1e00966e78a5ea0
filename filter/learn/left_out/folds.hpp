#pragma once

#include <vector>

#include "filter/learn/tuning.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// One part of a cross-validation: both recordings hold training runs only.
struct ValidationSplit {
  Recording training;
  Recording left_out;
};

/// Which of the parts each run is left out with: the longest first, each to the part that is shortest so far.
std::vector<Index> deal_by_length(const std::vector<Index>& lengths, Index parts);

/// Splits of the training runs for cross-validation: every run is left out once; with more than `most` runs several are
/// left out together, dealt by length so that the parts are about equal. Fewer than three training runs are cut into
/// `most` contiguous stretches each first (those too short to be cut are only trained on). Empty when nothing can be
/// left out. The test runs never enter.
std::vector<ValidationSplit> validation_splits(const Recording& recording, Index most, const RefineTuning& tuning = {});

}  // namespace modebank
