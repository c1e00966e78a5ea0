#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "ident/base/work_counter.hpp"

namespace modebank::app {

/// As long as this object exists, loops that last over a second print their progress to standard error. A terminal
/// shows one line that is rewritten; other outputs get a line every ten seconds.
class ProgressMeter {
 public:
  explicit ProgressMeter(bool wanted);
  ~ProgressMeter();
  ProgressMeter(const ProgressMeter&) = delete;
  ProgressMeter& operator=(const ProgressMeter&) = delete;

 private:
  void watch();
  void tell(const WorkDone& work);

  bool terminal_ = false, stopped_ = false, line_open_ = false;
  std::mutex mutex_;
  std::condition_variable stop_;
  std::thread thread_;
};

/// Text such as "windows: 12000 of 50000, 3.1e+04 per s, 1.2 s left". Before the first item it does not contain the
/// time left.
std::string progress_text(const WorkDone& work);

}  // namespace modebank::app
