#pragma once

#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// How a channel's values are computed at the times of another table. States are interpolated; inputs are held.
enum class Bring { interpolated, held };

/// Sets `channels` (rows) of `target` from the same rows of `source`, at the target's times. Both must be in order of
/// time. Drops samples of the target outside the source's time span. Values that would be interpolated across a gap
/// become NaN. Throws DataError if no sample remains.
void bring_to(FileStream& target, const FileStream& source, const std::vector<Index>& channels, Bring how);

}  // namespace modebank
