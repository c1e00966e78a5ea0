#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "app/study/run/study_worker.hpp"

namespace modebank::app {

/// Prints the progress of a study to stderr. A terminal shows one line that is rewritten; other outputs get occasional
/// lines.
class StudyProgress {
 public:
  explicit StudyProgress(std::vector<std::string> varied_keys);
  ~StudyProgress();
  StudyProgress(const StudyProgress&) = delete;
  StudyProgress& operator=(const StudyProgress&) = delete;

  void tell(const TrialRow& row, const TrialReport& report, std::size_t finished, std::size_t all);

 private:
  using Clock = std::chrono::steady_clock;
  void note(const TrialRow& row, const TrialReport& report);
  std::string line(std::size_t finished, std::size_t all) const;

  std::vector<std::string> varied_keys_;
  bool terminal_;
  Clock::time_point start_ = Clock::now(), told_ = start_;
  bool line_open_ = false;
  std::size_t computed_ = 0, failed_ = 0;
};

/// The varied values as text for messages: "mixture.components = 9, bank.stay = 0.95".
std::string describe_trial(const std::vector<std::string>& varied_keys, const TrialRow& row);

}  // namespace modebank::app
