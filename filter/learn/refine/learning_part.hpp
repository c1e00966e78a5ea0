#pragma once

#include <cstdint>
#include <optional>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// A part of the training runs for learning, as separate runs. `most`: largest number of transitions; 0 takes all. It
/// consists of whole contiguous stretches, so that dynamics and stays in a mode are kept. The runs laid end to end are
/// divided into equal shares, and the seed draws one stretch from each share. So every run is represented in proportion
/// to its length. A stretch has most / 100 transitions, at least 100; shorter runs are taken whole. The draw depends on
/// the runs, `most` and the seed alone. If the runs have no more transitions than `most`, the result is empty, and the
/// caller uses all runs. Held-out runs are excluded.
std::optional<Recording> learning_part(const Recording& recording, Eigen::Index most, std::uint64_t seed);

}  // namespace modebank
