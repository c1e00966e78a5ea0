#include "app/cli/command_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "app/cli/commands.hpp"
#include "app/config/option_table.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

const std::vector<std::string> chain_keys{"data", "window", "mixture", "bank", "filter", "archive", "job"};

constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();
const Arguments one_config{"CONFIG", "needs one configuration file", 1, 1};
const Arguments no_name{"", "takes no name", 0, 0};
const Arguments one_archive{"ARCHIVE", "needs one archive", 1, 1};

CommandOption output(const std::string& what, const std::string& help) {
  return {"output,o", what, help, &CommandLine::output};
}
CommandOption force(const std::string& help) { return {"force", "", help, &CommandLine::force}; }
CommandOption dry_run(const std::string& help = "list the files to read and write, then stop") {
  return {"dry-run", "", help, &CommandLine::dry_run};
}
CommandOption as_json(const std::string& help = "print the result as one JSON object") {
  return {"json", "", help, &CommandLine::json};
}

std::vector<Command> commands_to_start() {
  return {
      {"Start",
       "demo",
       no_name,
       "simulate a robot on two grounds, find them, and compare them with the truth",
       "Needs no file. The motion on each ground is linear.",
       "modebank demo",
       {"data", "window", "mixture", "bank", "filter", "archive", "job", "simulate"},
       {as_json(), output("FOLDER", "folder of its files (modebank_demo)"),
        force("also if that folder contains other files")},
       run_demo,
       {"archive.bank"}},
      {"Start",
       "init",
       {"LOG...", "needs one or more logs", 1, any_number},
       "read logs, or a folder of logs, and write a configuration to start from",
       "CSV, ROS 1 bag, ROS 2 MCAP and .db3, MATLAB, HDF5: every channel with its unit, rate, range and gaps; time, "
       "states and inputs are guessed, each guess with its reason beside it.",
       "modebank init robot.bag",
       {},
       {as_json(), output("FILE", "path of the configuration (named after the log)"),
        force("overwrite a configuration of that name")},
       run_init},
      {"Start",
       "check",
       one_config,
       "facts about the data before anything is fitted",
       "Reports clocks, gaps, repeats, excitation and outliers of each run, and what to do about them.",
       "modebank check robot.ini",
       chain_keys,
       {as_json()},
       run_check},
  };
}

std::vector<Command> commands_to_identify() {
  const std::vector<CommandOption> written{as_json(), dry_run()};
  const std::vector<CommandOption> archived{as_json(), dry_run(), force("replace an archive of other data")};
  return {
      {"Identify",
       "run",
       {"CONFIG | LOG...", "needs one configuration file, or logs", 1, any_number},
       "the whole chain, from log to verdict: writes an archive and prints a summary",
       "Fits windows, clusters them, learns a bank of modes and judges it on held-out runs against simpler models. "
       "From "
       "logs it writes NAME.ini, NAME.h5 and NAME.html into the current folder: `init` proposes the configuration.",
       "modebank run robot.bag",
       chain_keys,
       {as_json(),
        {"until", "windows | mixture | bank", "stop after this stage and archive what there is", &CommandLine::until},
        dry_run("list the files to read and write and, of a CONFIG, every key with its origin, then stop"),
        force("replace an archive of other data; with logs, all files")},
       run_pipeline},
      {"Identify",
       "study",
       one_config,
       "run a chain for many settings, on one machine or on a Slurm cluster",
       "Plans, runs and merges; finished runs are not repeated. --study.stage executes a single step.",
       "modebank study robot.ini --study.vary 'window.length = 20 | 40 | 80'",
       {"data", "window", "mixture", "bank", "filter", "job", "study"},
       written,
       run_study},
      {"Identify",
       "simulate",
       one_config,
       "write runs with known truth, in a layout that run reads",
       "",
       "modebank simulate robot.ini",
       {"data.state", "data.input", "job", "simulate"},
       written,
       run_simulate},
  };
}

std::vector<Command> commands_to_use() {
  return {
      {"Use",
       "show",
       {"ARCHIVE [PATH]", "needs an archive and at most one path in it", 1, 2},
       "all results of a run, or one object of the archive",
       "",
       "modebank show robot.h5 /bank/A",
       {},
       {as_json(),
        {"csv", "", "print the table or array at PATH as CSV; with --run a group, one row per sample",
         &CommandLine::csv},
        {"run", "NAME", "print only the rows of this run, in arrays over samples and in tables", &CommandLine::run},
        {"form", "increment | full", "of A: x[k+1] - x[k] = A x[k], or x[k+1] = A x[k]", &CommandLine::form}},
       run_show},
      {"Use",
       "report",
       {"ARCHIVE|STUDY|FOLDER [ARCHIVE]", "needs an archive, a study, a folder of archives, or two archives to compare",
        1, 2},
       "a page that opens offline in a browser: of a run, a study, two runs side by side, or a folder",
       "For a folder of archives it makes SITE/index.html, a table with links, and a page for each "
       "archive and study. Later calls make only pages whose archive changed.",
       "modebank report robot.h5",
       {"report"},
       {as_json(), output("FILE|SITE", "path of the page, or folder of the pages (named after the archive or folder)")},
       run_report},
      {"Use",
       "track",
       one_archive,
       "filter live: reads samples line by line from standard input, or a log, and prints estimates",
       "Input: a header with the archive's columns, then one line per sample (or JSON objects with these names), in "
       "any form that `run` reads. A missing state is an empty field. --data.inputs FILE reads a recorded log instead. "
       "Output lines: the estimate, its interval, the modes' probabilities, the prediction for the next sample, an "
       "alarm.",
       "modebank track robot.h5 < log.csv",
       {"data", "filter.variant", "track"},
       {as_json("print JSON objects; this is the default for JSON input")},
       run_track,
       {"data.truth", "data.label"}},
      {"Use",
       "predict",
       one_archive,
       "predict a run from a few measured samples, then inputs only",
       "Files need the archive's columns; states after the first samples may be missing. Prints, per sample and state, "
       "the prediction with its standard deviation and 95 % band, and the most probable mode.",
       "modebank predict robot.h5 --data.inputs plan.csv --samples 10",
       {"data", "filter", "track.filter", "job"},
       {as_json(),
        {"samples", "N", "number of measured samples at the start; short for --filter.simulate", "filter.simulate"},
        {"filter", "NAME", "filter of the archive; short for --track.filter", "track.filter"},
        output("FILE", "CSV file (standard output)")},
       run_predict,
       {"data.truth", "data.label", "filter.horizon"}},
      {"Use",
       "export",
       {"ARCHIVE --to FORM", "needs one archive", 1, 1},
       "the bank for other programs: json, or a filter in c",
       "Both forms are x[k+1] = A x[k] + B u[k] + c: json one page with errors and units; c a C99 filter without heap. "
       "Refused where the verdict on its uncertainty is overconfident or underconfident.",
       "modebank export robot.h5 --to c -o tracker.c",
       {"track.filter"},
       {as_json(),
        {"to", "json | c", "form", &CommandLine::to},
        output("FILE", "file (c: its header is written beside it)"),
        force("export the bank in spite of this verdict")},
       run_export},
      {"Use",
       "verify",
       {"ARCHIVE...", "needs at least one archive", 1, any_number},
       "check hash, schema and completeness",
       "",
       "modebank verify robot.h5",
       {},
       {as_json()},
       run_verify},
  };
}

std::vector<Command> commands_about() {
  return {
      {"About",
       "help",
       {"[COMMAND | SECTION | KEY | TERM]", "", 0, any_number},
       "explain a command, a key or a word of the summary",
       "",
       "modebank help window.length",
       {},
       {as_json("print one JSON object; without a word, all commands, keys and terms")},
       nullptr},
  };
}

}  // namespace

std::string CommandOption::typed() const {
  const std::string value = argument.empty() ? "" : " " + argument;
  const std::size_t comma = name.find(',');
  return (comma == std::string::npos ? "" : fmt::format("-{}{}, ", name.substr(comma + 1), value)) + "--" +
         long_name() + value;
}

std::vector<std::string> CommandOption::choices() const { return choices_in(argument); }

bool Command::reads(const std::string& key) const {
  if (std::find(not_keys.begin(), not_keys.end(), key) != not_keys.end()) return false;
  return std::any_of(keys.begin(), keys.end(),
                     [&](const std::string& known) { return key == known || key.rfind(known + ".", 0) == 0; });
}

const CommandOption* Command::find_option(const std::string& long_name) const {
  for (const std::vector<CommandOption>* list : {&options, &common_options()})
    for (const CommandOption& option : *list)
      if (option.long_name() == long_name) return &option;
  return nullptr;
}

const std::vector<Command>& command_table() {
  static const std::vector<Command> table = [] {
    std::vector<Command> all;
    for (auto group : {commands_to_start, commands_to_identify, commands_to_use, commands_about})
      for (Command& command : group()) all.push_back(std::move(command));
    return all;
  }();
  return table;
}

const std::vector<CommandOption>& common_options() {
  static const std::vector<CommandOption> options{
      {"help,h", "", "explain the command and its options", &CommandLine::help},
      {"quiet,q", "", "errors only on standard error", &CommandLine::quiet},
      {"verbose,v", "", "also print every candidate that was tried", &CommandLine::verbose},
      {"version", "", "version and revision", &CommandLine::version}};
  return options;
}

const Command* find_command(const std::string& name) {
  const std::vector<Command>& table = command_table();
  const auto found = std::find_if(table.begin(), table.end(), [&](const Command& c) { return c.name == name; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace modebank::app
