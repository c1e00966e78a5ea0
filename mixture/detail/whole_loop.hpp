#pragma once

#include <tbb/task_group.h>

#include <stdexcept>

namespace modebank {

/// Throws if the present parallel loop was cancelled. An exception in an outer loop cancels the inner loop, which then
/// returns with unfinished work. Call this function before the results are used.
inline void require_whole_loop() {
  if (tbb::is_current_task_group_canceling())
    throw std::runtime_error("cancelled by an exception in an enclosing loop");
}

}  // namespace modebank
