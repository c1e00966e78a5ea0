#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/study/run/trial_store.hpp"
#include "app/study/run/trial_worker.hpp"
#include "app/study/space/study_plan.hpp"
#include "io/archive/study_file.hpp"

namespace modebank::app {

/// How far a study is.
struct StudyState {
  std::size_t finished = 0, all = 0;
  double seconds = 0.0;  ///< until the page is written anew; 0: the study has ended
};

/// Writes the page of a study's folder; an own hand writes it, since studies know nothing of pages.
using StudyPageWriter = std::function<void(const std::filesystem::path& folder, const StudyFile& file,
                                           const StudyTable& table, const StudyState& state)>;

/// The page of a study that still runs: every few seconds with what is finished, read from the archives once each. What
/// it costs stays below a tenth of the time.
class LivePage {
 public:
  LivePage(const StudyPlan& plan, TrialStore store, StudyPageWriter write);
  void tell(const TrialRow& row, const TrialReport& report, std::size_t finished, std::size_t all);

 private:
  using Clock = std::chrono::steady_clock;
  void take(std::size_t row, const TrialReport& report);
  void write(std::size_t finished, std::size_t all);

  const StudyPlan& plan_;
  TrialStore store_;
  StudyPageWriter write_;
  StudyTable table_;
  std::vector<std::optional<TrialScores>> scores_;
  std::map<std::string, std::size_t> rows_;  ///< by key
  Clock::time_point next_ = Clock::now();
  bool failed_ = false;
};

}  // namespace modebank::app
