#include "app/study/run/live_page.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "app/study/answers/merge_study.hpp"

namespace modebank::app {
namespace {

constexpr double interval_s = 5.0;
constexpr double share_of_time = 0.1;

}  // namespace

LivePage::LivePage(const StudyPlan& plan, TrialStore store, StudyPageWriter write)
    : plan_(plan), store_(std::move(store)), write_(std::move(write)), table_(plan.table) {
  scores_.resize(table_.rows.size());
  for (std::size_t i = 0; i < table_.rows.size(); ++i) {
    if (table_.rows[i].status != TrialStatus::dropped) table_.rows[i].status = TrialStatus::planned;
    rows_[table_.rows[i].key] = i;
  }
}

void LivePage::take(std::size_t row, const TrialReport& report) {
  TrialRow& taken = table_.rows[row];
  if (report.outcome == TrialOutcome::failed) {
    taken.status = TrialStatus::failed;
    taken.message = report.message;
  } else if (report.outcome == TrialOutcome::computed || report.outcome == TrialOutcome::present) {
    scores_[row] = read_trial_scores(store_.archive(taken.key));
    taken.status = TrialStatus::done;
  }
}

void LivePage::write(std::size_t finished, std::size_t all) {
  const Clock::time_point start = Clock::now();
  const StudyTable table = with_scores(table_, scores_);
  const StudyFile file{plan_.provenance, plan_.config, "study", table_columns(table), {}, {}};
  write_(store_.folder(), file, table, {finished, all, interval_s});
  const double took_s = std::chrono::duration<double>(Clock::now() - start).count();
  next_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                             std::chrono::duration<double>(std::max(interval_s, took_s / share_of_time)));
}

void LivePage::tell(const TrialRow& row, const TrialReport& report, std::size_t finished, std::size_t all) {
  const auto found = rows_.find(row.key);
  if (failed_ || found == rows_.end()) return;
  // A page that cannot be written costs nobody the study.
  try {
    take(found->second, report);
    if (Clock::now() >= next_) write(finished, all);
  } catch (const std::exception& error) {
    failed_ = true;
    spdlog::warn("study.page: the page is not written any more: {}", error.what());
  }
}

}  // namespace modebank::app
