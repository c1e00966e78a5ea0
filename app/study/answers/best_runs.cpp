#include "app/study/answers/best_runs.hpp"

#include <fmt/format.h>

#include <string>

#include "app/config/config_file.hpp"
#include "app/study/answers/answers_text.hpp"
#include "io/files/replace_file.hpp"

namespace modebank::app {

namespace {

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

}  // namespace

void write_best_run(const std::filesystem::path& folder, const Config& study, const StudyTable& table,
                    const Answers& answers) {
  for (const BestSetting& best : answers.best)
    if (best.score == answers.headline) replace_file(folder / "study.best.ini", {best_run_text(study, table, best)});
}

}  // namespace modebank::app
