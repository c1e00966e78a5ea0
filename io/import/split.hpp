#pragma once

#include <string>
#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// Splits a run. Without a split, returns the run itself.
/// - Blocks of equal length, in order of time: RUN.b1, RUN.b2, .... The first, third, ... train, the others test.
/// - Or two parts: the last percents, which test, and the part before, which trains.
///
/// At the end of every block but the last, `options.gap_samples` of the joined run are dropped, so that no window or
/// lag crosses a boundary. Throws DataError for a block that is shorter than the gap.
std::vector<RunStreams> split_run(const RunStreams& run, const SplitOptions& options, double rate_hz);

/// A value of data.split for one run of this length. `gap_samples` are dropped between blocks. Blocks: at most ten,
/// each at least four gaps long; otherwise the last 30 %.
std::string proposed_split(Index samples, Index gap_samples);

/// Sentence on the split, for the user.
std::string split_note(const RunStreams& run, const std::vector<RunStreams>& blocks, const SplitOptions& options);

}  // namespace modebank
