#pragma once

#include <functional>

namespace modebank {

/// While it lives, long computations that this thread calls pass `hook` now and then: what it throws ends them. Worker
/// threads do not call it; an exception in this one ends their share, too (oneTBB cancels the rest of a loop).
class Interruptible {
 public:
  explicit Interruptible(std::function<void()> hook);
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  std::function<void()> hook_;
  const std::function<void()>* outer_;
};

/// For loops that may take seconds: calls this thread's hook, if there is one.
void interruption_point();

}  // namespace modebank
