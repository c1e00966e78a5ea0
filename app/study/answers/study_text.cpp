#include "app/study/answers/study_text.hpp"

#include <fmt/format.h>

#include <map>

#include "app/study/run/study_progress.hpp"

namespace modebank::app {
namespace {

constexpr std::size_t most_listed = 20;

std::string list_of(const StudyTable& table, TrialStatus status) {
  std::string text;
  std::size_t listed = 0, more = 0;
  for (const TrialRow& row : table.rows) {
    if (row.status != status) continue;
    if (listed++ >= most_listed)
      ++more;
    else
      text += fmt::format("  {}: {}{}\n", name_of(status), describe_trial(table.varied_keys, row),
                          row.message.empty() ? "" : ": " + row.message);
  }
  if (more > 0) text += fmt::format("  {}: and {} more, in study.csv\n", name_of(status), more);
  return text;
}

}  // namespace

std::string plan_text(const StudyPlan& plan, std::int64_t repeats) {
  std::size_t runs = 0, dropped = 0;
  for (const TrialRow& row : plan.table.rows) ++(row.status == TrialStatus::dropped ? dropped : runs);
  std::string text = fmt::format("plan      {} runs", runs);
  if (repeats > 1) text += fmt::format(" ({} repeats of each point)", repeats);
  text += "\n";
  if (plan.repeated_points > 0)
    text += fmt::format("          {} points are equal to an earlier one and were left out\n", plan.repeated_points);
  if (dropped > 0) text += fmt::format("          {} points are not valid configurations and were dropped:\n", dropped);
  return text + list_of(plan.table, TrialStatus::dropped);
}

std::string table_text(const StudyTable& table, const TrialStore& store) {
  std::map<TrialStatus, std::size_t> counts;
  for (const TrialRow& row : table.rows) ++counts[row.status];
  std::string text = fmt::format("study     {}:", store.folder().string());
  for (const auto& [status, count] : counts)
    text += fmt::format("{} {} {}", status == counts.begin()->first ? "" : ",", count, name_of(status));
  text += "\n" + list_of(table, TrialStatus::failed) + list_of(table, TrialStatus::missing);
  return text;
}

}  // namespace modebank::app
