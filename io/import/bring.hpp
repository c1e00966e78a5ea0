#pragma once

#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// How the values of a channel at the times of another table are computed: states are interpolated, inputs held.
enum class Bring { interpolated, held };

/// Sets `channels` (rows) of `target` from the same rows of `source`, at the target's times. Both are in order of time.
/// Drops samples of the target outside the source's time span. Values that would be interpolated across a gap become
/// NaN. Throws DataError if no sample is left.
void bring_to(FileStream& target, const FileStream& source, const std::vector<Index>& channels, Bring how);

}  // namespace modebank
