#include "app/study/answers/best_runs.hpp"

#include <fmt/format.h>

#include <set>

#include "app/config/config_file.hpp"
#include "app/study/answers/answers_text.hpp"
#include "ident/base/characters.hpp"
#include "io/files/replace_file.hpp"

namespace modebank::app {

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

namespace {

/// File name for a score. A score ends in the name of a state, which may contain any character, even those of a path:
/// "/imu.wz".
std::string file_stem_of(const std::string& score, std::set<std::string>& taken) {
  constexpr std::size_t longest = 200;  // a file name has at most 255 bytes
  const std::string base = letters_and_digits(score).substr(0, longest);
  std::string stem = base;
  for (int i = 2; !taken.insert(stem).second; ++i) stem = fmt::format("{}_{}", base, i);
  return stem;
}

}  // namespace

void write_best_runs(const std::filesystem::path& folder, const Config& study, const StudyTable& table,
                     const Answers& answers) {
  make_own_folder(folder / "best");
  std::set<std::string> taken;
  for (const BestSetting& best : answers.best) {
    if (best.score.rfind("bank_", 0) != 0) continue;
    const std::string text = best_run_text(study, table, best);
    replace_file(folder / "best" / (file_stem_of(best.score, taken) + ".ini"), {text});
    if (best.score == answers.headline) replace_file(folder / "study.best.ini", {text});
  }
}

}  // namespace modebank::app
