#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/page/run_page.hpp"
#include "app/report/page/study_page.hpp"
#include "app/report/page/write_page.hpp"
#include "app/study/answers/answers.hpp"
#include "app/study/space/study_plan.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/inspect.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app::report {
namespace {

namespace fs = std::filesystem;

/// Finished runs, the best by the headline score first; none without that score.
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

/// Archives that are there, for all rows.
std::vector<TrialPlace> archives_of(const StudyTable& table, const fs::path& folder) {
  std::vector<TrialPlace> places(table.rows.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const fs::path archive = trial_archive(folder, table.rows[i].key);
    std::error_code error;
    if (!table.rows[i].key.empty() && fs::is_regular_file(archive, error)) places[i].archive = archive.string();
  }
  return places;
}

/// Pages of the best runs, in a folder named after the study's page.
void write_run_pages(const StudyTable& table, const fs::path& page, const ReportConfig& options,
                     std::vector<TrialPlace>& places, Written& written) {
  const fs::path folder = page.parent_path() / (page.stem().string() + "_runs");
  Index pages = 0;
  for (const std::size_t row : ranked_rows(table)) {
    if (pages == options.runs) break;
    if (places[row].archive.empty()) continue;
    const fs::path archive = places[row].archive, file = folder / (table.rows[row].key + ".html");
    const Page run = run_page(read_archive(archive, Evaluations::in_file), archive.filename().string(), options);
    fs::create_directories(folder);
    write_page(file, run, written);
    places[row].page = (folder.filename() / file.filename()).string();
    ++pages;
  }
}

void write_study_page(const fs::path& study, const fs::path& path, const StudyFile& file, const StudyTable& table,
                      const fs::path& page, const ReportConfig& options, Written& written) {
  std::vector<TrialPlace> places = archives_of(table, path.parent_path());
  write_run_pages(table, page, options, places, written);
  const fs::path name = fs::absolute(fs::is_directory(study) ? study : path).lexically_normal();
  write_page(page,
             study_page(file, table, places, (name.has_filename() ? name : name.parent_path()).filename().string()),
             written);
}

}  // namespace

void write_running_study(const fs::path& folder, const StudyFile& file, const StudyTable& table,
                         const StudyState& state, Written& written) {
  const bool ended = state.seconds == 0.0;
  const fs::path path = folder / "study.html", name = fs::absolute(folder).lexically_normal();
  // While it runs, archives are left to those who write them.
  const std::vector<TrialPlace> places =
      ended ? archives_of(table, folder) : std::vector<TrialPlace>(table.rows.size());
  Page page = study_page(file, table, places, (name.has_filename() ? name : name.parent_path()).filename().string());
  if (ended) return write_page(path, page, written);
  page.data["study"]["live"] = {{"finished", state.finished}, {"all", state.all}, {"seconds", state.seconds}};
  replace_file(path, {html_of(page)});
}

fs::path study_file(const fs::path& study) {
  if (!fs::is_directory(study)) return study;
  const fs::path file = study / "study.h5";
  if (fs::exists(file)) return file;
  if (fs::exists(plan_file(study)))
    throw DataError(
        fmt::format("{}: the study is not merged yet: modebank study CONFIG --study.stage merge makes "
                    "study.h5 of the runs that are done",
                    study.string()));
  throw ConfigurationError(fmt::format("{}: no study's folder: it holds neither study.h5 nor plan.h5", study.string()));
}

bool is_study(const OpenArchive& file) { return inspect(file, "/").at("members").contains("study"); }

void report_study(const fs::path& study, const OpenArchive& opened, const fs::path& page, const ReportConfig& options,
                  Written& written) {
  const fs::path& path = opened.path();
  check_page_path(page, {path});
  const StudyFile file = read_study_file(opened, "study");
  const StudyTable table = study_table_of(file);
  write_study_page(study, path, file, table, page, options, written);
}

}  // namespace modebank::app::report
