#pragma once

#include <string>
#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// The blocks of a run, in order of time: RUN.b1, RUN.b2, ..., of equal length; or the part before the last percents,
/// and these. The first, third, ... train, the others test. `options.gap_samples` of the joined run are dropped at the
/// end of every block but the last, so that no window or lag crosses a boundary. Without a split the run itself. Throws
/// DataError for blocks that are shorter than the gap.
std::vector<RunStreams> split_run(const RunStreams& run, const SplitOptions& options, double rate_hz);

/// A value for data.split, for one run of this many samples with `gap_samples` dropped between blocks: at most ten
/// blocks, each at least four gaps long; else the last 30 %.
std::string proposed_split(Index samples, Index gap_samples);

/// Sentence on the split, for the user.
std::string split_note(const RunStreams& run, const std::vector<RunStreams>& blocks, const SplitOptions& options);

}  // namespace modebank
