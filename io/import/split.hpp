#pragma once

#include <string>
#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// Splits a run. If no split is requested, returns the run itself.
/// - Blocks of equal length, in order of time: RUN.b1, RUN.b2, .... Odd blocks are for training, even blocks for
/// testing.
/// - Or two parts: the last part of the run, in percent, is for testing, the part before it for training.
///
/// At the end of every block except the last, `options.gap_samples` samples of the joined run are dropped. Windows and
/// lags therefore cross no boundary. Throws DataError if a block is shorter than the gap.
std::vector<RunStreams> split_run(const RunStreams& run, const SplitOptions& options, double rate_hz);

/// A value of data.split that suits one run of this length. `gap_samples` samples are dropped between blocks. The run
/// gets at most ten blocks, each with at least four times the gap. If it is too short for blocks, the last 30 % are for
/// testing.
std::string proposed_split(Index samples, Index gap_samples);

/// A sentence for the user that describes the split.
std::string split_note(const RunStreams& run, const std::vector<RunStreams>& blocks, const SplitOptions& options);

}  // namespace modebank
