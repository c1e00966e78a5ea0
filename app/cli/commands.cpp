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
  const char* more = "";  ///< what `help COMMAND` adds
};

constexpr Command commands[] = {
    {"init", "FILE...",
     "look into logs of any kind, list their channels and write a configuration to start from (-o FILE, --force); asks "
     "on a "
     "terminal whether state and inputs are right, --yes never asks",
     run_init},
    {"run", "CONFIG", "the whole chain: import, windows, mixture, bank, evaluation, archive, summary", run_pipeline},
    {"demo", "[-o FOLDER]",
     "simulates a robot on ice and grip with known truth and runs the whole chain on it, in FOLDER (modebank_demo); "
     "--force where that holds other files",
     run_demo},
    {"identify", "CONFIG", "fit the windows and archive them", run_pipeline},
    {"cluster", "CONFIG", "cluster the windows (of --archive.input, if given)", run_pipeline},
    {"evaluate", "CONFIG", "learn the bank and score it (stages of --archive.input; or the bank of --archive.bank)",
     run_pipeline},
    {"check", "CONFIG",
     "advice on the data before identification, run by run, and settings that gain in cross-validation; --json; "
     "--apply -o FILE writes the configuration with them; --findings leaves the settings out, which take minutes on "
     "large data",
     run_check},
    {"simulate", "CONFIG", "write runs with known truth in the CSV layout that run reads", run_simulate},
    {"study", "CONFIG", "a parameter study: plans, runs and merges, resuming what is done; --study.stage does one step",
     run_study},
    {"show", "ARCHIVE [PATH]", "provenance, candidates, modes, summary; or one object; --json; --form full", run_show},
    {"track", "ARCHIVE", "live filter: samples in on standard input, estimates out on standard output, line by line",
     run_track,
     "  Lines in: a header with the time and the archive's states and inputs (or JSON objects of these names), then a\n"
     "  sample per line; a state that was not measured stays empty. Lines out: the estimate with its 95 % interval, "
     "the\n"
     "  modes' probabilities, the prediction for the next sample and an alarm.\n"
     "    modebank track my_robot.h5 < samples.csv > estimates.csv\n"
     "  Keys: --track.filter (which of the archive's filters), --track.checkpoint and --track.resume (go on later).\n"},
    {"predict", "ARCHIVE",
     "free run on new inputs (--data.inputs FILES --samples N [--horizon H] [--filter NAME]): CSV on standard output, "
     "or -o FILE",
     run_predict,
     "  Predicts from the first N measured samples and the inputs alone; without --data.inputs the archive's own "
     "runs.\n"
     "    modebank predict my_robot.h5 --data.inputs new.csv --samples 3 --horizon 50 -o predicted.csv\n"
     "  Files need the archive's columns; states after the first N samples may be missing. Lines out: per sample and\n"
     "  state the prediction, its standard deviation and 95 % band, and the most probable mode. --filter drifting, or\n"
     "  another of the archive's filters, takes the bank's place.\n"},
    {"export", "ARCHIVE --to FORM",
     "the bank for other programs: json, mat, c [--float], casadi, ros2 [--wheel_separation_m W --wheel_radius_m R], "
     "or "
     "csv --table PATH; -o FILE or folder; --force where its verdict is overconfident or underconfident",
     run_export,
     "  json    one page, stable schema (standard output, or -o FILE)\n"
     "  mat     A, B, c, C, Q, R, T for MATLAB and Octave (NAME.mat)\n"
     "  c       C99 filter and prediction without heap or dependencies (NAME.c, NAME.h); --float for single precision\n"
     "  casadi  Python text: step and linearised model for MPC (standard output, or -o FILE)\n"
     "  ros2    parameter files, one per mode (folder NAME_ros2); --wheel_separation_m W --wheel_radius_m R say what\n"
     "          the archive cannot know\n"
     "  csv     any table: --table /evaluation/summary (modebank show ARCHIVE / lists them)\n"
     "  Every form is x[k+1] = A x[k] + B u[k] + c; --track.filter says which of the archive's filters. "
     "docs/export.md\n"
     "  has the schemas.\n"},
    {"report", "ARCHIVE|STUDY [ARCHIVE]",
     "an interactive page that opens offline in a browser (-o page.html): of a run, a study, or two runs", run_report},
    {"verify", "ARCHIVE...",
     "check hash, schema and completeness of archives and study folders; --repair removes what is broken in the latter",
     run_verify},
};

}  // namespace

std::string help_text() {
  std::string text = "usage: modebank COMMAND [FILE...] [--key value ...]\n\nCommands\n";
  for (const Command& command : commands)
    text += fmt::format("  {:<24} {}\n", fmt::format("{} {}", command.name, command.arguments), command.help);
  text +=
      "\nOptions: -h [ --help ], --version, --json, --form increment | full (show), -o FILE (report, predict, init, "
      "export, "
      "check; demo: FOLDER), --apply, --findings (check), --repair (verify), --force (init, demo, export).\n"
      "Every configuration key is an option too, and wins over the file. Exit status: 0 done; 2 usage, configuration "
      "or "
      "path; 1 content or run failure. `modebank help TERM` says what a word of the summary or a key means.\n";
  return text + option_help();
}

namespace {

/// What a command, a term or a key means.
std::string help_of(const std::string& name) {
  for (const Command& command : commands)
    if (command.name == name)
      return fmt::format("modebank {} {}\n  {}\n{}", command.name, command.arguments, command.help, command.more);
  return meaning_of(name);
}

}  // namespace

int run_command(const CommandLine& line) {
  if (line.version) {
    fmt::print("modebank {} ({})\n", build_info::version, build_info::git_revision);
    return 0;
  }
  if (line.help || line.command == "help") {
    if (line.help && !line.command.empty() && line.command != "help" && line.files.empty()) {
      fmt::print("{}", help_of(line.command));
      return 0;
    }
    for (const std::string& name : line.files) fmt::print("{}", help_of(name));
    if (line.files.empty()) fmt::print("{}", line.markdown ? option_markdown() : help_text());
    return 0;
  }
  for (const Command& command : commands)
    if (line.command == command.name) return command.run(line);
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
