#include "app/study/study.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "app/chain/provenance.hpp"
#include "app/study/answers/answers_text.hpp"
#include "app/study/answers/merge_study.hpp"
#include "app/study/answers/study_text.hpp"
#include "app/study/launch/submit_study.hpp"
#include "app/study/run/claim.hpp"
#include "app/study/run/run_trials.hpp"
#include "app/study/run/study_progress.hpp"
#include "app/text/number_text.hpp"
#include "io/archive/archive_form.hpp"
#include "io/files/output_file.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// One execution of `modebank study`.
struct StudyCommand {
  const StudyCall& call;
  const Config& config;
  TrialStore store;
};

bool has_plan(const std::filesystem::path& folder) {
  refuse_special_file(plan_file(folder));
  return std::filesystem::exists(plan_file(folder));
}

/// Files that the study writes under common names. Each entry has the text with which the study's own file begins.
/// Links are not listed, because the study's file replaces a link.
std::vector<OutputFile> files_in_place(const std::filesystem::path& folder) {
  constexpr std::size_t line_bytes = 4096;
  const auto at = [&](const char* name, FileForm form) {
    return OutputFile{"study.output", folder / name, std::move(form)};
  };
  std::vector<OutputFile> files{
      at("study.csv", form_by_front("a table of a study", "repeat,seed,status,message,", line_bytes)),
      at("log.csv", form_by_front("a log of a study", "Z,", sizeof "2026-01-01T00:00:00Z")),
      at("study.best.ini", form_by_front("a configuration of a study", "# Best of a study by ", line_bytes)),
      at("study.h5", {"a table of a study", is_table_of_runs})};
  std::erase_if(files, [](const OutputFile& file) { return std::filesystem::is_symlink(file.path); });
  return files;
}

/// Checks a folder before the first file of a study is written there. The study must replace neither foreign files nor
/// data.
void check_folder(const StudyCommand& command, const StudyPlan& plan) {
  std::vector<std::filesystem::path> sources{command.call.config_file};
  for (const InputFile& file : plan.provenance.inputs) sources.emplace_back(file.path);
  if (!std::filesystem::is_directory(command.store.folder())) return;
  const bool is_study = has_plan(command.store.folder());
  for (OutputFile file : files_in_place(command.store.folder())) {
    if (is_study) file.form.is_one = [](const std::filesystem::path&) { return true; };
    check_output(file, sources);
  }
}

/// Writes the plan of the configuration to the folder. If the folder has an earlier plan, its runs must be part of the
/// new plan.
StudyPlan settle_plan(const StudyCommand& command) {
  StudyPlan plan = make_plan(command.config, make_provenance(config_hash(command.config), command.call.typed));
  check_folder(command, plan);
  command.store.create();
  const Claim alone = Claim::wait_for(command.store.plan_claim());
  if (has_plan(command.store.folder())) {
    const StudyPlan before = read_plan(command.store.folder());
    check_plan_goes_on(before, plan, command.store.folder());
    if (before.config == plan.config && before.table.rows.size() == plan.table.rows.size()) return plan;
  }
  write_plan(command.store.folder(), plan);
  return plan;
}

void print_plan(const StudyCommand& command, const StudyPlan& plan) {
  command.call.say(plan_text(plan, command.config.study.repeats));
}

/// Throws DataError if the study had to stop.
RunResult run_plan(const StudyCommand& command, const StudyPlan& plan) {
  command.store.remove_leftovers();
  StudyProgress progress(plan.table.varied_keys);
  const RunResult result = run_trials({command.config, command.call.typed, plan.provenance.modebank_version}, plan,
                                      group_trials(command.config, plan),
                                      [&](const TrialRow& row, const TrialReport& report, std::size_t finished,
                                          std::size_t all) { progress.tell(row, report, finished, all); });
  const std::string counts = fmt::format("{} runs made, {} existed, {} failed, in {}", result.computed, result.present,
                                         result.failed.size(), duration_text(result.seconds));
  if (result.broken)
    throw DataError(
        fmt::format("the study stopped ({}): {}\nfinished runs are kept; the same command continues from there", counts,
                    *result.broken));
  command.call.say(fmt::format("run       {}\n", counts));
  return result;
}

bool is_complete(const StudyTable& table) {
  for (const TrialRow& row : table.rows)
    if (row.status == TrialStatus::failed || row.status == TrialStatus::missing) return false;
  return true;
}

/// Throws unless there is a plan. The steps merge and status need one.
void require_plan(const StudyCommand& command) {
  if (!has_plan(command.store.folder()))
    throw ConfigurationError(fmt::format("{}: the study has no plan yet; run the study, or --study.stage plan, first",
                                         plan_file(command.store.folder()).string()));
}

/// Configuration of the best setting by one score, ready for `modebank run`, with a comment that explains it.
std::string best_run_text(const Config& study, const StudyTable& table, const BestSetting& best) {
  const TrialRow& row = table.rows[best.row];
  Config config = trial_config(study, table.varied_keys, row);
  config.archive.output.clear();  // the trial's path belongs to the study's folder
  std::string text =
      fmt::format("# Best of a study by {} ({} is better): {:.6g}", best.score, best.goal.text(), best.value);
  if (best.repeats > 1) text += fmt::format(", mean of {} repeats; the seed is that of the first", best.repeats);
  text += fmt::format("\n# {}\n# trial {}\n", setting_text(table, best.row), row.key);
  if (best.score.find("_test_") != std::string::npos)
    text += "# It was chosen by the held-out runs, so their scores are too good. Judge it on other runs.\n";
  return text + "\n" + resolved_text(config);
}

/// Writes study.best.ini, the setting that is best by the headline, into the study's folder.
void write_best_run(const std::filesystem::path& folder, const Config& study, const StudyTable& table,
                    const Answers& answers) {
  for (const BestSetting& best : answers.best)
    if (best.score == answers.headline) replace_file(folder / "study.best.ini", {best_run_text(study, table, best)});
}

int merge(const StudyCommand& command, const std::set<std::string>& whole) {
  command.store.look_again();
  require_plan(command);
  const Claim alone = Claim::wait_for(command.store.plan_claim());
  const StudyPlan plan = read_plan(command.store.folder());  // the plan is read again, because another process may have
                                                             // added values
  check_plan_is_of(plan, command.config, command.store.folder());
  const StudyTable table = collect_table(command.store, plan, whole);
  const Answers answers = answer(table);
  write_study(command.store, plan, table, answers);
  command.call.say(table_text(table, command.store));
  write_best_run(command.store.folder(), command.config, table, answers);
  command.call.say(fmt::format("\n{}\ntable     {}, {}\n", answers_text(table, answers),
                               (command.store.folder() / "study.h5").string(),
                               (command.store.folder() / "study.csv").string()));
  return is_complete(table) ? 0 : 1;
}

int run_all(const StudyCommand& command) {
  const StudyPlan plan = settle_plan(command);
  print_plan(command, plan);
  const RunResult result = run_plan(command, plan);
  return merge(command, {result.whole.begin(), result.whole.end()});
}

int show_status(const StudyCommand& command) {
  require_plan(command);
  const StudyPlan plan = read_plan(command.store.folder());
  const StudyTable table = collect_table(command.store, plan);
  command.call.say(table_text(table, command.store));
  return is_complete(table) ? 0 : 1;
}

int plan_alone(const StudyCommand& command) {
  print_plan(command, settle_plan(command));
  return 0;
}

int submit(const StudyCommand& command) {
  check_submission(command.call);
  const StudyPlan plan = settle_plan(command);
  print_plan(command, plan);
  command.call.say(submit_study(command.call, collect_table(command.store, plan)));
  return 0;
}

}  // namespace

int do_study(const StudyCall& call) {
  const TrialStore store(call.config.study.output);
  store.look_again();
  const StudyCommand command{call, call.config, store};
  switch (call.config.study.stage) {
    case StudyStage::all:
      return run_all(command);
    case StudyStage::plan:
      return plan_alone(command);
    case StudyStage::run:
      return run_plan(command, settle_plan(command)).failed.empty() ? 0 : 1;
    case StudyStage::merge:
      return merge(command, {});
    case StudyStage::status:
      return show_status(command);
    case StudyStage::submit:
      return submit(command);
  }
  return 0;
}

}  // namespace modebank::app
