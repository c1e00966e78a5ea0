#pragma once

#include <functional>

namespace modebank {

/// During its lifetime, long computations of this thread call `hook` from time to time. An exception from `hook` ends
/// the computation. Worker threads do not call `hook`, but the exception ends their work too: oneTBB cancels the rest
/// of a loop.
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

/// Calls this thread's hook, if it has one. Loops that may take seconds call this function.
void interruption_point();

}  // namespace modebank
