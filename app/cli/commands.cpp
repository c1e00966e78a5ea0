#include "app/cli/commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>

#include "app/chain/build_info.hpp"
#include "app/cli/help_text.hpp"
#include "app/config/option_table.hpp"
#include "app/study/answers/verify_study.hpp"
#include "ident/base/nearest_name.hpp"
#include "io/archive/archive.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

struct Command {
  const char* name;
  const char* arguments;
  const char* help;
  int (*run)(const CommandLine&);
  const char* sections;  ///< of the configuration whose keys it reads, or single keys; by blanks
  const char* options;   ///< other than keys; by blanks
};

constexpr const char* chain_sections = "data window mixture bank filter archive job";

constexpr Command commands[] = {
    {"init", "FILE...",
     "look into logs of any kind, list their channels and write a configuration to start from (-o FILE, --force)",
     run_init, "", "output force yes"},
    {"run", "CONFIG", "the whole chain: import, windows, mixture, bank, evaluation, archive, summary", run_pipeline,
     chain_sections, "force"},
    {"demo", "[-o FOLDER]",
     "simulates a robot on ice and grip with known truth and runs the whole chain on it, in FOLDER (modebank_demo); "
     "--force where that holds other files",
     run_demo, "data window mixture bank filter archive job simulate", "output force"},
    {"identify", "CONFIG", "fit the windows and archive them", run_pipeline, "data window archive job", "force"},
    {"cluster", "CONFIG", "cluster the windows (of --archive.input, if given)", run_pipeline,
     "data window mixture archive job", "force"},
    {"evaluate", "CONFIG", "learn the bank and score it (stages of --archive.input; or the bank of --archive.bank)",
     run_pipeline, chain_sections, "force"},
    {"check", "CONFIG",
     "advice on the data before identification, run by run, and settings that gain in cross-validation; --json; "
     "--apply -o FILE writes the configuration with them; --findings leaves the settings out, which take minutes on "
     "large data",
     run_check, chain_sections, "json apply findings output"},
    {"simulate", "CONFIG", "write runs with known truth in the CSV layout that run reads", run_simulate,
     "data simulate job", ""},
    {"study", "CONFIG", "a parameter study: plans, runs and merges, resuming what is done; --study.stage does one step",
     run_study, "data window mixture bank filter archive job study", ""},
    {"show", "ARCHIVE [PATH]", "provenance, candidates, modes, summary; or one object; --json; --form full", run_show,
     "", "json form"},
    {"track", "ARCHIVE", "live filter: samples in on standard input, estimates out on standard output, line by line",
     run_track, "data filter track job.seed", ""},
    {"predict", "ARCHIVE",
     "free run on new inputs (--data.inputs FILES --samples N [--horizon H] [--filter NAME]): CSV on standard output, "
     "or -o FILE",
     run_predict, "data filter track.filter job.seed", "output samples horizon filter"},
    {"export", "ARCHIVE --to FORM",
     "the bank for other programs: json, mat, c [--float], casadi, ros2 [--wheel_separation_m W --wheel_radius_m R], "
     "or "
     "csv --table PATH; -o FILE or folder; --force where its verdict is overconfident or underconfident",
     run_export, "track.filter", "to table float wheel_separation_m wheel_radius_m output force"},
    {"report", "ARCHIVE|STUDY [ARCHIVE]",
     "an interactive page that opens offline in a browser (-o page.html): of a run, a study, or two runs", run_report,
     "report", "output"},
    {"verify", "ARCHIVE...",
     "check hash, schema and completeness of archives and study folders; --repair removes what is broken in the latter",
     run_verify, "", "repair"},
};

}  // namespace

std::string help_text() {
  std::string text = "usage: modebank COMMAND [FILE...] [--key value ...]\n\nCommands\n";
  for (const Command& command : commands)
    text += fmt::format("  {:<24} {}\n", fmt::format("{} {}", command.name, command.arguments), command.help);
  text +=
      "\nOptions: -h [ --help ], --version, --json, --form increment | full (show), -o FILE (report, predict, init, "
      "export, "
      "check; demo: FOLDER), --apply, --findings (check), --repair (verify), --force (init, demo, export, and what "
      "writes an "
      "archive over one of other data).\n"
      "Every configuration key is an option too, and wins over the file. Exit status: 0 done; 2 usage, configuration "
      "or "
      "path; 1 content or run failure. `modebank help TERM` says what a word of the summary or a key means.\n";
  return text + option_help();
}

namespace {

std::vector<std::string> words_of(const char* text) {
  std::vector<std::string> words;
  boost::split(words, text, boost::is_any_of(" "), boost::token_compress_on);
  std::erase(words, "");
  return words;
}

bool holds(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string typed_option(const std::string& name) { return name == "output" ? "-o" : "--" + name; }

std::string listed(const std::vector<std::string>& words, const std::string& none) {
  return words.empty() ? none : fmt::format("{}", fmt::join(words, ", "));
}

/// Something typed and not read would be a wish that nobody heard.
void refuse_unread(const Command& command, const CommandLine& line) {
  const std::vector<std::string> sections = words_of(command.sections), options = words_of(command.options);
  for (const std::string& name : line.given) {
    if (holds(options, name)) continue;
    std::vector<std::string> typed;
    for (const std::string& option : options) typed.push_back(typed_option(option));
    throw ConfigurationError(fmt::format("{} does not read {}; its options are {}", command.name, typed_option(name),
                                         listed(typed, "none but keys")));
  }
  for (const auto& [key, value] : line.overrides)
    if (!holds(sections, key.substr(0, key.find('.'))) && !holds(sections, key))
      throw ConfigurationError(
          fmt::format("{} does not read --{}; its sections are {}", command.name, key, listed(sections, "none")));
}

}  // namespace

int run_command(const CommandLine& line) {
  if (line.version) {
    fmt::print("modebank {} ({})\n", build_info::version, build_info::git_revision);
    return 0;
  }
  if (line.help || line.command == "help") {
    for (const std::string& name : line.files) fmt::print("{}", meaning_of(name));
    if (line.files.empty()) fmt::print("{}", line.markdown ? option_markdown() : help_text());
    return 0;
  }
  for (const Command& command : commands)
    if (line.command == command.name) {
      refuse_unread(command, line);
      return command.run(line);
    }
  std::vector<std::string> names;
  for (const Command& command : commands) names.emplace_back(command.name);
  if (line.command.empty())
    throw ConfigurationError(fmt::format("no command; one of {} (see --help)", fmt::join(names, ", ")));
  throw ConfigurationError(fmt::format("unknown command {}{}; commands are {}", line.command,
                                       did_you_mean(line.command, names), fmt::join(names, ", ")));
}

namespace {

bool report_archive(const std::string& file) {
  const Verification result = verify_archive(file);
  if (result.ok()) fmt::print("{}: ok\n", file);
  for (const std::string& problem : result.problems) fmt::print("{}: {}\n", file, problem);
  return result.ok();
}

/// Whether all is well, or repaired as far as files go.
bool report_study(const std::string& folder, bool repair) {
  const StudyVerification result = verify_study(folder);
  for (const StudyProblem& problem : result.problems)
    fmt::print("{}: {}{}{}\n", problem.file.string(), problem.what,
               problem.redo.empty() ? "" : "; to redo: " + problem.redo,
               repair && problem.removable ? "; removed" : "");
  if (repair) repair_study(folder, result);
  fmt::print("{}: {} trials are whole{}\n", folder, result.whole,
             result.problems.empty() ? ": ok" : fmt::format(", {} problems", result.problems.size()));
  return result.problems.empty();
}

}  // namespace

int run_verify(const CommandLine& line) {
  if (line.files.empty()) throw ConfigurationError("verify needs at least one archive: modebank verify ARCHIVE...");
  bool all_good = true;
  for (const std::string& file : line.files) {
    const bool good = is_study_folder(file) ? report_study(file, line.repair) : report_archive(file);
    all_good = all_good && good;
  }
  return all_good ? 0 : 1;
}

}  // namespace modebank::app
