#pragma once

#include <string>
#include <vector>

#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// Values of this magnitude or above are invalid. Filters treat such values as missing, and the square of the largest
/// ones overflows a double.
inline constexpr double largest_value = 1e30;

/// Throws DataError if a state, an input or a true state is at least `largest_value` in magnitude. The message contains
/// file, line, run, column and value.
void check_values(const RunStreams& run, const DataOptions& options);

/// If data.missing = predict, adds a remark for every state that has no value in a run. With any other data.missing,
/// throws DataError for such a state. Throws it for every input without values. The message contains file, run and
/// column.
std::vector<std::string> columns_without_value(const RunStreams& run, const DataOptions& options);

/// Adds a remark for every column in which a few values have more than half of the squared distance from the median.
/// Training runs and held-out runs are checked separately. Least squares would fit only these values.
/// "A few" means at most five values, or one in a thousand if that is more. Below 125 values it means at most one in
/// 25. The remark contains the largest value, with file, line and run.
std::vector<std::string> dominating_values(const std::vector<RunStreams>& runs, const DataOptions& options);

}  // namespace modebank
