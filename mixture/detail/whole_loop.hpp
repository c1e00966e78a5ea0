#pragma once

#include <tbb/task_group.h>

#include <stdexcept>

namespace modebank {

/// After a parallel loop whose results are used at once: an exception in a loop around it cancels this one, too, which
/// then returns without having done all of its part. What follows must not take that for results.
inline void require_whole_loop() {
  if (tbb::is_current_task_group_canceling()) throw std::runtime_error("cancelled by an exception in a loop around it");
}

}  // namespace modebank
