#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/import/run_streams.hpp"

namespace modebank {

/// Index, in the order of the file, of the first stamp that differs from its neighbours by orders of magnitude. There
/// are three cases: stamps return afterwards; the stamp is the first or the last and far beyond all others; or it
/// begins a jump that is large beside the steps on both sides, as when a clock is set during a recording. Gaps,
/// disorder and restarted clocks do not count.
std::optional<std::size_t> stamp_far_out(const std::vector<std::int64_t>& stamps_ns);

/// Number of rows at the beginning that were stamped before the clock was set. After these rows the stamps leap forward
/// by a year or more, far beyond the steps and spans on both sides. Returns 0 for more than half of the rows. Missing
/// stamps are ignored.
std::size_t rows_before_clock_was_set(const std::vector<std::int64_t>& stamps_ns);

/// End of a message on times that go backwards or repeat at sample k: a possible cause, or empty if none is known.
std::string disorder_hint(const FileStream& source, Index k);

}  // namespace modebank
