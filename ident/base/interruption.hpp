#pragma once

#include <functional>

namespace modebank {

/// During its lifetime, long computations called by this thread call `hook` from time to time; an exception from it
/// ends them. Worker threads do not call it. An exception in this thread also ends their work, because oneTBB cancels
/// the rest of a loop.
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

/// Calls this thread's hook, if there is one. For loops that may take seconds.
void interruption_point();

}  // namespace modebank
