#pragma once

#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// How samples of one table become samples at the times of another: as states and inputs do when they are joined.
enum class Bring { interpolated, held };

/// Sets `channels` (rows) of `target` from the same rows of `source`, at the target's times; both are in order of time.
/// Samples of the target outside the source's span are dropped, and interpolated values across a gap become NaN. Throws
/// DataError when none is left.
void bring_to(FileStream& target, const FileStream& source, const std::vector<Index>& channels, Bring how);

}  // namespace modebank
