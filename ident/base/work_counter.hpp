#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <string>

namespace modebank {

/// How far a loop is.
struct WorkDone {
  std::string what;  ///< that it counts: "windows"
  std::size_t done = 0, all = 0;
  double seconds = 0.0;  ///< since it began
};

/// Counts off a loop that may take seconds, for whoever shows how it goes on. Of counters that live at once the first
/// is the one that is seen: loops within it, and other computations beside it, count unseen. Any thread may count.
class WorkCounter {
 public:
  WorkCounter(std::string what, std::size_t all);
  ~WorkCounter();
  WorkCounter(const WorkCounter&) = delete;
  WorkCounter& operator=(const WorkCounter&) = delete;

  void add(std::size_t count = 1) { done_ += count; }

  /// What is counted now; nothing between loops.
  static std::optional<WorkDone> seen();

 private:
  std::atomic<std::size_t> done_ = 0;
};

}  // namespace modebank
