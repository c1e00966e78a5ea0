#pragma once

#include <string>
#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// The blocks of a run, in order of time: RUN.b1, RUN.b2, ..., of equal length, or what comes before and the last
/// percents. The first, third, ... train, the others test. `options.gap_samples` of the joined run are dropped at the
/// end of every block but the last, so that no window and no lag reaches from one into the next. Without a split the
/// run itself. Throws DataError for blocks that the gap would use up.
std::vector<RunStreams> split_run(const RunStreams& run, const SplitOptions& options, double rate_hz);

/// What data.split may be for one run of so many samples, `gap_samples` of which are dropped between blocks: as many
/// blocks, up to ten, as leave each four gaps long, else the last 30 %.
std::string proposed_split(Index samples, Index gap_samples);

/// What was done, for the user.
std::string split_note(const RunStreams& run, const std::vector<RunStreams>& blocks, const SplitOptions& options);

}  // namespace modebank
