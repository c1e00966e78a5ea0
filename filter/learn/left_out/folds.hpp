#pragma once

#include <vector>

#include "filter/learn/tuning.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// One split of a cross-validation; both recordings hold training runs only.
struct ValidationSplit {
  Recording training;
  Recording left_out;
};

/// The part with which each run is left out. The longest runs are dealt first, each to the shortest part so far.
std::vector<Index> deal_by_length(const std::vector<Index>& lengths, Index parts);

/// Splits of the training runs for cross-validation. Every run is left out once. Above `most` runs several are left out
/// together, dealt by length into parts of about equal size. Fewer than three runs are first cut into `most` contiguous
/// stretches each; runs too short for that are only trained on. Empty if nothing can be left out. Held-out runs are
/// never used.
std::vector<ValidationSplit> validation_splits(const Recording& recording, Index most, const RefineTuning& tuning = {});

}  // namespace modebank
