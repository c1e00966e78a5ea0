#pragma once

#include <string>
#include <vector>

#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// From here on a value is none: filters take it as missing, and what is far beyond has no square in a double.
inline constexpr double largest_value = 1e30;

/// Throws DataError, naming file, line, run, column and value, for a state, an input or a true state from
/// `largest_value` on.
void check_values(const RunStreams& run, const DataOptions& options);

/// A line for every state that was never measured in a run, which data.missing = predict takes. Throws DataError,
/// naming file, run and column, where nothing can be done without: of an input, or where the samples are left out.
std::vector<std::string> columns_without_value(const RunStreams& run, const DataOptions& options);

/// A line for every column, of the training runs or of those held out, of whose spread about its median few values
/// (five, of few samples one in 25, of many one in a thousand at most) hold more than half, the largest of them named
/// by file, line and run: least squares would follow them alone, and scores be about them.
std::vector<std::string> dominating_values(const std::vector<RunStreams>& runs, const DataOptions& options);

}  // namespace modebank
