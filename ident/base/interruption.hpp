#pragma once

#include <functional>

namespace modebank {

/// During its lifetime, long computations called by this thread call `hook` from time to time. An exception from `hook`
/// ends them. Worker threads do not call the hook. An exception in this thread also ends their work, because oneTBB
/// cancels the rest of a loop.
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

/// Calls this thread's hook, if it has one. For loops that may take seconds.
void interruption_point();

}  // namespace modebank
