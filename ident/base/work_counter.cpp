#include "ident/base/work_counter.hpp"

#include <chrono>
#include <mutex>
#include <utility>

namespace modebank {
namespace {

using Clock = std::chrono::steady_clock;

/// The counter whose progress is displayed.
struct Seen {
  std::mutex mutex;
  const WorkCounter* counter = nullptr;
  WorkDone work;
  Clock::time_point start;
};

Seen& shared() {
  static Seen seen;
  return seen;
}

}  // namespace

WorkCounter::WorkCounter(std::string what, std::size_t all) {
  Seen& seen = shared();
  const std::lock_guard lock(seen.mutex);
  if (seen.counter != nullptr) return;
  seen.counter = this;
  seen.work = {std::move(what), 0, all, 0.0};
  seen.start = Clock::now();
}

WorkCounter::~WorkCounter() {
  Seen& seen = shared();
  const std::lock_guard lock(seen.mutex);
  if (seen.counter == this) seen.counter = nullptr;
}

std::optional<WorkDone> WorkCounter::seen() {
  Seen& seen = shared();
  const std::lock_guard lock(seen.mutex);
  if (seen.counter == nullptr) return std::nullopt;
  WorkDone work = seen.work;
  work.done = seen.counter->done_;
  work.seconds = std::chrono::duration<double>(Clock::now() - seen.start).count();
  return work;
}

}  // namespace modebank
