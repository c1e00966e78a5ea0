#pragma once

#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// How a channel is brought to the times of another table: states are interpolated, inputs held.
enum class Bring { interpolated, held };

/// Sets `channels` (rows) of `target` from the same rows of `source`, at the target's times; both are in order of time.
/// Drops samples of the target outside the source's span. Interpolated values across a gap become NaN. Throws DataError
/// when no sample is left.
void bring_to(FileStream& target, const FileStream& source, const std::vector<Index>& channels, Bring how);

}  // namespace modebank
