#include "app/cli/progress_meter.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>

#include "app/text/number_text.hpp"
#include "ident/base/printable.hpp"
#include "io/files/standard_error.hpp"

namespace modebank::app {

std::string progress_text(const WorkDone& work) {
  std::string text = fmt::format("{}: {} of {}", work.what, work.done, work.all);
  if (work.done == 0 || !(work.seconds > 0.0)) return text;
  const double rate = static_cast<double>(work.done) / work.seconds;
  text += ", " + rate_text(rate);
  if (work.done < work.all)
    text += fmt::format(", {} left", duration_text(static_cast<double>(work.all - work.done) / rate));
  return text;
}

ProgressMeter::ProgressMeter(bool wanted) : terminal_(::isatty(STDERR_FILENO) == 1) {
  if (wanted) thread_ = std::thread([this] { watch(); });
}

ProgressMeter::~ProgressMeter() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  stop_.notify_one();
  thread_.join();
  if (line_open_) say("\r\x1b[K");
}

void ProgressMeter::watch() {
  using namespace std::chrono_literals;
  constexpr double worth_a_line_s = 1.0;
  const auto interval = terminal_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(10s);
  std::unique_lock lock(mutex_);
  while (!stop_.wait_for(lock, interval, [this] { return stopped_; })) {
    const std::optional<WorkDone> work = WorkCounter::seen();
    if (work && work->seconds > worth_a_line_s) tell(*work);
  }
}

/// The cursor returns to the start of the line, so that the next message overwrites the line.
void ProgressMeter::tell(const WorkDone& work) {
  const std::string text = printable_name(progress_text(work));
  say(terminal_ ? fmt::format("\r{}\x1b[K\r", text) : text + "\n");
  line_open_ = terminal_;
}

}  // namespace modebank::app
