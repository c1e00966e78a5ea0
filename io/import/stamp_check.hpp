#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// Median of all positive steps; 0 without any.
double median_step(const std::vector<double>& times);

/// Index, in the order of the file, of the first stamp that differs from its neighbours by orders of magnitude. There
/// are three cases:
/// - later stamps are normal again;
/// - the stamp is the first or the last, and far from all others;
/// - the stamp begins a jump much larger than the steps on both sides, for example because a clock is set during a
/// recording.
/// Gaps, disorder and restarted clocks do not count.
std::optional<std::size_t> stamp_far_out(const std::vector<std::int64_t>& stamps_ns);

/// Number of rows at the beginning that were stamped before the clock was set. After these rows the stamps jump forward
/// by at least a year, far more than the steps and spans on both sides. Returns 0 if more than half of the rows would
/// count. Missing stamps are ignored.
std::size_t rows_before_clock_was_set(const std::vector<std::int64_t>& stamps_ns);

/// The rows where a clock falls back to its start and then advances: another drive follows in the file. A note says so.
std::vector<std::size_t> clock_restarts(const std::vector<double>& times, std::vector<std::string>& notes);

/// Text to append to the message "times go backwards or repeat at sample k". It states a possible cause. Empty if no
/// cause is known.
std::string disorder_hint(const FileStream& source, Index k);

}  // namespace modebank
