#pragma once

#include <cstdint>
#include <optional>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// At most `most` transitions of the training runs to learn from (0: all), as runs of their own: whole contiguous
/// stretches, so that dynamics and dwell times are kept, one drawn by the seed from each of as many equal shares of the
/// runs laid end to end, so that every run is there in proportion to its length. A stretch has most / 100 transitions,
/// at least 100; shorter runs are taken whole. The draw depends on the runs, `most` and the seed alone. Empty where the
/// runs have no more: all of them are learned from, as they are. Test runs are left out.
std::optional<Recording> learning_part(const Recording& recording, Eigen::Index most, std::uint64_t seed);

}  // namespace modebank
