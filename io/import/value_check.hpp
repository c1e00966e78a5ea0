#pragma once

#include <string>
#include <vector>

#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// Larger magnitudes are not valid: filters treat them as missing, and still larger ones have no square in a double.
inline constexpr double largest_value = 1e30;

/// Throws DataError, with file, line, run, column and value, for a state, an input or a true state of at least
/// `largest_value`.
void check_values(const RunStreams& run, const DataOptions& options);

/// A remark for every state without a value in a run, which data.missing = predict allows. Throws DataError, with file,
/// run and column, for an input without values, and for such a state with another data.missing.
std::vector<std::string> columns_without_value(const RunStreams& run, const DataOptions& options);

/// A remark for every column in which few values have more than half of the squared distance from the median, in the
/// training or in the held-out runs. Least squares would follow these values alone. Few are five at most; one in 25 of
/// few samples, one in a thousand of many. The remark has the largest of them, with file, line and run.
std::vector<std::string> dominating_values(const std::vector<RunStreams>& runs, const DataOptions& options);

}  // namespace modebank
