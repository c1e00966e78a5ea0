#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "app/report/page/run_page.hpp"
#include "app/report/page/study_page.hpp"
#include "app/report/page/write_page.hpp"
#include "app/study/answers/answers.hpp"
#include "app/study/answers/merge_study.hpp"
#include "app/study/answers/study_text.hpp"
#include "app/study/space/study_plan.hpp"
#include "io/archive/inspect.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app::report {
namespace {

namespace fs = std::filesystem;

/// Finished runs that have the headline score, the best first.
std::vector<std::size_t> ranked_rows(const StudyTable& table) {
  const std::string headline = answer(table).headline;
  const auto found = std::find(table.score_names.begin(), table.score_names.end(), headline);
  const std::optional<ScoreGoal> goal = goal_of(headline, 1);
  std::vector<std::size_t> rows;
  if (found == table.score_names.end() || !goal) return rows;
  const auto loss = [&](std::size_t row) {
    return goal->loss(table.rows[row].scores[static_cast<std::size_t>(found - table.score_names.begin())]);
  };
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    if (table.rows[i].status == TrialStatus::done && !std::isnan(loss(i))) rows.push_back(i);
  std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return loss(a) < loss(b); });
  return rows;
}

/// Paths of the archives that exist, for all rows.
std::vector<TrialPlace> archives_of(const StudyTable& table, const fs::path& folder) {
  std::vector<TrialPlace> places(table.rows.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const fs::path archive = trial_archive(folder, table.rows[i].key);
    std::error_code error;
    if (!table.rows[i].key.empty() && fs::is_regular_file(archive, error)) places[i].archive = archive.string();
  }
  return places;
}

/// Writes the pages of the best runs into a folder with the name of the study's page.
void write_run_pages(const StudyTable& table, const fs::path& page, const ReportConfig& options,
                     std::vector<TrialPlace>& places, Written& written) {
  const fs::path folder = page.parent_path() / (page.stem().string() + "_runs");
  constexpr Index most_pages = 10;
  Index pages = 0;
  for (const std::size_t row : ranked_rows(table)) {
    if (pages == most_pages) break;
    if (places[row].archive.empty()) continue;
    const fs::path archive = places[row].archive, file = folder / (table.rows[row].key + ".html");
    const Page run = run_page(read_archive(archive, Evaluations::in_file), archive.filename().string(), options);
    fs::create_directories(folder);
    write_page(file, run, written);
    places[row].page = (folder.filename() / file.filename()).string();
    ++pages;
  }
}

/// Whether study.h5 has the results of all planned runs.
bool is_merged(const StudyFile& merged, const StudyPlan& plan) {
  const StudyTable table = study_table_of(merged);
  std::set<std::string> settled;
  for (const TrialRow& row : table.rows)
    if (row.status != TrialStatus::missing) settled.insert(row.key);
  return std::all_of(plan.table.rows.begin(), plan.table.rows.end(),
                     [&](const TrialRow& row) { return settled.count(row.key) > 0; });
}

FoundStudy counted(FoundStudy study, const StudyTable& table) {
  for (const TrialRow& row : table.rows) {
    study.runs += row.status != TrialStatus::dropped;
    study.done += row.status == TrialStatus::done;
  }
  return study;
}

void write_study_page(const FoundStudy& study, const StudyTable& table, const fs::path& page,
                      const ReportConfig& options, Written& written) {
  std::vector<TrialPlace> places = archives_of(table, study.file.parent_path());
  write_run_pages(table, page, options, places, written);
  const fs::path name = fs::absolute(study.name).lexically_normal();
  write_page(
      page,
      study_page(study.content, table, places, (name.has_filename() ? name : name.parent_path()).filename().string()),
      written);
}

}  // namespace

FoundStudy find_study(const fs::path& folder, Written& written) {
  const fs::path file = folder / "study.h5";
  const bool has_plan = fs::exists(plan_file(folder));
  if (!fs::exists(file) && !has_plan)
    throw ConfigurationError(
        fmt::format("{}: not a study's folder, because it has neither study.h5 nor plan.h5", folder.string()));
  std::optional<FoundStudy> merged;
  if (fs::exists(file)) merged = find_study(OpenArchive(file));
  if (merged) merged->name = folder;
  if (merged && !has_plan) return *merged;
  const StudyPlan plan = read_plan(folder);
  if (merged && is_merged(merged->content, plan)) return *merged;
  const TrialStore store(folder);
  const StudyTable table = collect_table(store, plan);
  written.say(table_text(table, store));
  return counted({.name = folder, .file = file, .content = study_file_of(plan, table, answer(table))}, table);
}

FoundStudy find_study(const OpenArchive& file) {
  FoundStudy study{.name = file.path(), .file = file.path(), .content = read_study_file(file, "study"), .whole = true};
  return counted(study, study_table_of(study.content));
}

bool is_study(const OpenArchive& file) { return inspect(file, "/").at("members").contains("study"); }

void report_study(const FoundStudy& study, const fs::path& page, const ReportConfig& options, Written& written) {
  check_page_path(page, {study.file});
  write_study_page(study, study_table_of(study.content), page, options, written);
}

}  // namespace modebank::app::report
