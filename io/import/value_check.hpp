#pragma once

#include <string>
#include <vector>

#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// Values of at least this magnitude are not valid: filters treat them as missing, and the largest have no square in a
/// double.
inline constexpr double largest_value = 1e30;

/// Throws DataError with file, line, run, column and value for a state, an input or a true state of at least
/// `largest_value`.
void check_values(const RunStreams& run, const DataOptions& options);

/// Adds a remark for every state without a value in a run, if data.missing = predict. Throws DataError with file, run
/// and column for such a state with another data.missing, and for an input without values.
std::vector<std::string> columns_without_value(const RunStreams& run, const DataOptions& options);

/// A remark for every column in which a few values have more than half of the squared distance from the median, in the
/// training or in the held-out runs. Least squares would follow only these values. "A few" means at most five; at most
/// one in 25 of few samples, or one in a thousand of many. The remark states the largest value, with file, line and
/// run.
std::vector<std::string> dominating_values(const std::vector<RunStreams>& runs, const DataOptions& options);

}  // namespace modebank
