#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// Position of the first stamp (in the order of the file) that is out by orders of magnitude from its neighbours: one
/// that the next returns from, a first or last one far beyond all others, or a jump that dwarfs what is on either side
/// of it, as of a clock that is set while it records. Gaps, disorder and a clock that starts again are none.
std::optional<std::size_t> stamp_far_out(const std::vector<std::int64_t>& stamps_ns);

/// How many rows at the beginning were stamped before the clock was set: behind them stamps leap forward by a year or
/// more, beside which the steps and spans on both sides are small. 0 where these are more than half of the rows.
/// Missing stamps are none.
std::size_t rows_before_clock_was_set(const std::vector<std::int64_t>& stamps_ns);

/// What may be behind times that go backwards or repeat at sample k, as an ending of the message; empty: nothing known.
std::string disorder_hint(const FileStream& source, Index k);

}  // namespace modebank
