#include "app/study/run/study_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "app/text/number_text.hpp"
#include "ident/base/printable.hpp"
#include "io/files/standard_error.hpp"

namespace modebank::app {

StudyProgress::StudyProgress(std::vector<std::string> varied_keys)
    : varied_keys_(std::move(varied_keys)), terminal_(::isatty(STDERR_FILENO) == 1) {}

StudyProgress::~StudyProgress() {
  if (line_open_) say("\n");
}

void StudyProgress::note(const TrialRow& row, const TrialReport& report) {
  if (report.outcome == TrialOutcome::computed) ++computed_;
  if (report.outcome == TrialOutcome::failed) ++failed_;
  if (report.message.empty()) return;
  if (line_open_) say("\n");
  line_open_ = false;
  if (report.outcome == TrialOutcome::failed)
    say(printable(fmt::format("failed: {}: {}\n", describe_trial(varied_keys_, row), report.message)));
  else
    say(printable(report.message + "\n"));
}

void StudyProgress::tell(const TrialRow& row, const TrialReport& report, std::size_t finished, std::size_t all) {
  note(row, report);
  const double interval_s = terminal_ ? 0.2 : 10.0;
  const bool last = finished == all;
  if (!last && std::chrono::duration<double>(Clock::now() - told_).count() < interval_s) return;
  told_ = Clock::now();
  const std::string text = printable_name(line(finished, all));
  say(terminal_ ? fmt::format("\r{}\x1b[K", text) : text + "\n");
  line_open_ = terminal_;
}

std::string StudyProgress::line(std::size_t finished, std::size_t all) const {
  std::string text = fmt::format("{} of {} runs", finished, all);
  if (failed_ > 0) text += fmt::format(", {} failed", failed_);
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
  if (computed_ > 0 && elapsed_s > 0.0) {
    const double rate = static_cast<double>(computed_) / elapsed_s;
    text += ", " + rate_text(rate);
    if (finished < all) text += fmt::format(", {} left", duration_text(static_cast<double>(all - finished) / rate));
  }
  return text;
}

std::string describe_trial(const std::vector<std::string>& varied_keys, const TrialRow& row) {
  std::string text;
  for (std::size_t i = 0; i < varied_keys.size(); ++i)
    text += fmt::format("{}{} = {}", i == 0 ? "" : ", ", varied_keys[i], row.varied[i]);
  if (row.repeat > 0 || text.empty()) text += fmt::format("{}repeat {}", text.empty() ? "" : ", ", row.repeat);
  return text;
}

}  // namespace modebank::app
