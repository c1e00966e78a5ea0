#include "app/study/answers/verify_study.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <map>
#include <optional>

#include "app/config/config_file.hpp"
#include "app/study/run/study_progress.hpp"
#include "app/study/run/trial_store.hpp"
#include "app/study/space/study_plan.hpp"
#include "io/archive/study_file.hpp"
#include "io/files/sha256.hpp"
#include "io/files/temporary_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;

/// The fault in the archive of a planned trial; empty if there is none.
std::string trial_problem(const TrialStore& store, const Config& study, const StudyTable& table, const TrialRow& row) {
  try {
    const OpenArchive archive(store.archive(row.key));
    if (const auto problems = problems_of(archive); !problems.empty()) return problems.front();
    const TrialScores stored = read_trial_scores(archive);
    const Config trial = trial_config(study, table.varied_keys, row);
    if (stored.config_hash != config_hash(trial)) return "its configuration does not match its name";
    if (trial_key(trial, stored.data_hash, stored.modebank_version) != row.key)
      return "its data or version do not match its name";
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

/// Whether a path exists. A link without a target also counts.
bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::symlink_status(path, error).type() != fs::file_type::not_found;
}

/// If a file of the study exists, checks that it is complete.
void check_whole_file(const fs::path& file, StudyVerification& result) {
  if (!is_there(file)) return;
  try {
    for (const std::string& problem : verify_archive(file).problems)
      result.problems.push_back({file, problem, "", false});
  } catch (const std::exception& error) {
    result.problems.push_back({file, error.what(), "", false});
  }
}

std::optional<StudyPlan> check_plan(const fs::path& folder, StudyVerification& result) {
  const fs::path file = plan_file(folder);
  try {
    return read_plan(folder);
  } catch (const std::exception& error) {
    result.problems.push_back({file, error.what(), "", false});
    return std::nullopt;
  }
}

void check_trials(const TrialStore& store, const StudyPlan& plan, StudyVerification& result) {
  Config study = resolved_config(plan.config);
  study.study.output = store.folder().string();
  const std::vector<TrialRow>& rows = plan.table.rows;
  std::vector<std::string> found(rows.size());
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    if (rows[i].status != TrialStatus::dropped && store.has_archive(rows[i].key))
      found[i] = trial_problem(store, study, plan.table, rows[i]);
  });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].status == TrialStatus::dropped) continue;
    const fs::path file = store.archive(rows[i].key);
    const std::string redo = describe_trial(plan.table.varied_keys, rows[i]);
    if (const auto failure = store.failure(rows[i].key); failure && !store.has_archive(rows[i].key))
      result.problems.push_back({file, "failed: " + *failure, redo, false});
    else if (!store.has_archive(rows[i].key))
      result.problems.push_back({file, "missing", redo, false});
    else if (!found[i].empty())
      result.problems.push_back({file, found[i], redo, true});
    else
      ++result.whole;
  }
}

/// Reports incomplete files, and archives that do not belong to a planned trial. Of these archives only the hash can be
/// checked.
void check_others(const TrialStore& store, const std::optional<StudyPlan>& plan, StudyVerification& result) {
  std::error_code error;
  if (!fs::is_directory(store.folder() / "trials", error)) return;
  std::map<std::string, bool> planned;
  if (plan)
    for (const TrialRow& row : plan->table.rows) planned[row.key + ".h5"] = true;
  for (const fs::directory_entry& entry : fs::directory_iterator(store.folder() / "trials")) {
    const fs::path& file = entry.path();
    if (is_leftover(file)) result.problems.push_back({file, "left by a process that was killed", "", true});
    const bool is_trial = file.extension() == ".h5" && is_sha256(file.stem().string());
    if (!is_trial || planned.count(file.filename().string())) continue;
    for (const std::string& problem : store.problems(file.stem().string()))
      result.problems.push_back({file, problem, "", true});
  }
}

}  // namespace

bool is_study_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) && (is_there(plan_file(path)) || is_there(path / "trials"));
}

namespace {

/// Whether repair may remove a file. It must be inside the study's own folders trials/ and cache/, and no link may be
/// in its path.
bool lies_within(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  for (const char* part : {"trials", "cache"})
    if (fs::symlink_status(folder / part, error).type() == fs::file_type::directory &&
        file.parent_path() == folder / part && file.has_filename() && file.filename() != "." && file.filename() != "..")
      return true;
  return false;
}

}  // namespace

StudyVerification verify_study(const fs::path& folder) {
  const TrialStore store(folder);
  StudyVerification result;
  const std::optional<StudyPlan> plan = check_plan(folder, result);
  check_whole_file(folder / "study.h5", result);
  if (plan) check_trials(store, *plan, result);
  check_others(store, plan, result);
  for (StudyProblem& problem : result.problems)
    problem.removable = problem.removable && lies_within(folder, problem.file);
  return result;
}

void repair_study(const fs::path& folder, const StudyVerification& verification) {
  TrialStore(folder).remove_leftovers();
  for (const StudyProblem& problem : verification.problems)
    if (problem.removable) fs::remove(problem.file);
}

}  // namespace modebank::app
