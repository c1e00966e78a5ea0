#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <string>

namespace modebank {

/// Progress of a loop.
struct WorkDone {
  std::string what;  ///< unit of the count, such as "windows"
  std::size_t done = 0, all = 0;
  double seconds = 0.0;  ///< seconds since the loop began
};

/// Counts the progress of a loop that may take seconds, for display. If several counters exist, only the first one is
/// displayed: nested loops and parallel computations count without display. Thread-safe.
class WorkCounter {
 public:
  WorkCounter(std::string what, std::size_t all);
  ~WorkCounter();
  WorkCounter(const WorkCounter&) = delete;
  WorkCounter& operator=(const WorkCounter&) = delete;

  void add(std::size_t count = 1) { done_ += count; }

  /// The progress of the displayed counter; empty between loops.
  static std::optional<WorkDone> seen();

 private:
  std::atomic<std::size_t> done_ = 0;
};

}  // namespace modebank
