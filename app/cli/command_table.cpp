#include "app/cli/command_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/commands.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

const std::vector<std::string> chain_keys{"data", "window", "mixture", "bank", "filter", "archive", "job"};

CommandOption output(const std::string& what, const std::string& help) { return {"output,o", what, help}; }
CommandOption force(const std::string& help) { return {"force", "", help}; }
CommandOption dry_run() { return {"dry-run", "", "say what would be read and written, and stop"}; }
CommandOption as_json() { return {"json", "", "the result as one JSON object"}; }

std::vector<Command> commands_to_start() {
  return {
      {"Start",
       "demo",
       "",
       "simulate a robot on ice and grip and run the whole chain on it",
       "The ground is known there, so that what is found can be compared. Needs no file.",
       "modebank demo",
       {"data", "window", "mixture", "bank", "filter", "archive", "job", "simulate"},
       {as_json(), output("FOLDER", "where it has its files (modebank_demo)"),
        force("also where that folder holds other files")},
       run_demo},
      {"Start",
       "init",
       "FILE...",
       "look into logs and write a configuration to start from",
       "CSV, ROS 1 bag, ROS 2 MCAP and .db3, MATLAB, HDF5: every channel with its unit, rate, range and gaps; time, "
       "states and inputs are guessed, each guess with its reason beside it.",
       "modebank init robot.bag",
       {},
       {as_json(),
        output("FILE", "the configuration (named after the log)"),
        force("overwrite a configuration of that name"),
        {"yes", "", "ask nothing; without it a terminal is asked whether state and inputs are right"}},
       run_init},
      {"Start",
       "check",
       "CONFIG",
       "advice on the data before anything is fitted, and settings that gain",
       "Clocks, gaps, repeats, excitation and outliers, run by run; then settings that score better on training runs "
       "left out.",
       "modebank check robot.ini",
       chain_keys,
       {as_json(),
        {"findings", "", "leave the settings out, which take minutes on large data"},
        {"apply", "", "write the configuration with the suggested settings, to -o FILE"},
        output("FILE", "what --apply writes"),
        force("overwrite a configuration of that name")},
       run_check},
      {"Start",
       "config",
       "CONFIG",
       "the resolved configuration, and where each value comes from",
       "Of every key its value and its origin: line of the file, command line or default. It is itself a "
       "configuration.",
       "modebank config robot.ini",
       {"data", "window", "mixture", "bank", "filter", "archive", "job", "study", "track", "report", "simulate"},
       {as_json(), {"schema", "", "a JSON schema of all keys, for editors; takes no CONFIG"}},
       run_config},
  };
}

std::vector<Command> commands_to_identify() {
  const std::vector<CommandOption> written{as_json(), dry_run()};
  const std::vector<CommandOption> archived{as_json(), dry_run(), force("replace an archive of other data")};
  return {
      {"Identify", "run", "CONFIG", "the whole chain, from log to verdict: writes an archive and prints a summary",
       "Reads the runs, fits windows, clusters them, learns a bank of modes and judges it on held-out runs against "
       "models that one would use instead.",
       "modebank run robot.ini --window.length 30", chain_keys, archived, run_pipeline},
      {"Identify",
       "identify",
       "CONFIG",
       "fit the windows alone and archive them",
       "",
       "modebank identify robot.ini",
       {"data", "window", "archive", "job"},
       archived,
       run_pipeline},
      {"Identify",
       "cluster",
       "CONFIG",
       "cluster the windows (of --archive.input, if given)",
       "",
       "modebank cluster robot.ini --archive.input windows.h5",
       {"data", "window", "mixture", "archive", "job"},
       archived,
       run_pipeline},
      {"Identify", "evaluate", "CONFIG",
       "learn a bank and judge it (from --archive.input), or judge that of --archive.bank", "",
       "modebank evaluate other.ini --archive.bank robot.h5", chain_keys, archived, run_pipeline},
      {"Identify",
       "study",
       "CONFIG",
       "run a chain for many settings, on one machine or on a Slurm cluster",
       "Plans, runs and merges; what is done is not done again. --study.stage does one step.",
       "modebank study robot.ini --study.vary 'window.length = 20 | 40 | 80'",
       {"data", "window", "mixture", "bank", "filter", "job", "study"},
       written,
       run_study},
      {"Identify",
       "simulate",
       "CONFIG",
       "write runs with known truth, in a layout that run reads",
       "",
       "modebank simulate vehicle.ini",
       {"data.state", "data.input", "job", "simulate"},
       written,
       run_simulate},
  };
}

std::vector<Command> commands_to_use() {
  return {
      {"Use",
       "show",
       "ARCHIVE [PATH]",
       "all that a run found, or one object of the archive",
       "",
       "modebank show robot.h5 /bank/A",
       {},
       {as_json(),
        {"run", "NAME", "of arrays over samples and of tables, the rows of this run"},
        {"form", "increment | full", "of A: x[k+1] - x[k] = A x[k], or x[k+1] = A x[k]"}},
       run_show},
      {"Use",
       "report",
       "ARCHIVE|STUDY|FOLDER [ARCHIVE...]",
       "a page that opens offline in a browser: of a run, a study, runs side by side, or a folder",
       "A folder of archives becomes SITE/index.html, a table that sorts, filters and compares, with a page for each "
       "archive and study below the folder. Run again, it makes the pages whose archive changed.",
       "modebank report robot.h5",
       {"report"},
       {as_json(), output("FILE|SITE", "the page, or the folder of pages (named after the archive or folder)")},
       run_report},
      {"Use",
       "track",
       "ARCHIVE",
       "live filter: samples in on standard input or from --data.inputs, estimates out, line by line",
       "Lines in: a header with the columns that the archive was made from (or JSON objects of these names), then a "
       "sample each, in any form that `run` reads; a state that was not measured stays empty. --data.inputs FILE reads "
       "a "
       "recorded log in place of lines. Lines out: the estimate, its interval, the modes' probabilities, the "
       "prediction "
       "for the next sample, an alarm.",
       "modebank track robot.h5 < log.csv",
       {"data", "filter.variant", "filter.noise", "track"},
       {{"json", "", "lines out are JSON objects, as they are where lines in are"}},
       run_track,
       {"data.truth", "data.weight", "data.label"}},
      {"Use",
       "predict",
       "ARCHIVE",
       "free run: a few measured samples, then inputs only",
       "Files need the archive's columns; states after the first samples may be missing. Out comes, per sample and "
       "state, the prediction with its standard deviation and 95 % band, and the most probable mode.",
       "modebank predict robot.h5 --data.inputs plan.csv --samples 10",
       {"data", "filter", "track.filter", "job"},
       {as_json(),
        {"samples", "N", "measured samples at the start, short for --filter.simulate"},
        {"horizon", "H", "steps from there on, short for --filter.simulate_horizon"},
        {"filter", "NAME", "which model, short for --track.filter"},
        output("FILE", "CSV file (standard output)")},
       run_predict,
       {"data.truth", "data.weight", "data.label", "filter.horizon", "filter.smooth"}},
      {"Use",
       "export",
       "ARCHIVE --to FORM",
       "the bank for other programs: json, mat, c, casadi, ros2, or a table as csv",
       "Every form is x[k+1] = A x[k] + B u[k] + c: json one page; mat for MATLAB and Octave; c a C99 filter without "
       "heap; casadi Python text for MPC; ros2 parameter files, one per mode. Refused where the verdict on its "
       "uncertainty is overconfident or underconfident.",
       "modebank export robot.h5 --to c -o tracker.c",
       {"track.filter"},
       {as_json(),
        {"to", "FORM", "json, mat, c, casadi, ros2 or csv"},
        output("FILE", "file, or folder of ros2"),
        force("also where the verdict speaks against it"),
        {"table", "PATH", "csv: which table of the archive"},
        {"run", "NAME", "csv: the rows of this run; of /data or /evaluation/FILTER, a column per signal"},
        {"wheel_separation_m", "W", "ros2: as the controller has it"},
        {"wheel_radius_m", "R", "ros2: as the controller has it"}},
       run_export},
      {"Use",
       "verify",
       "ARCHIVE|STUDY...",
       "check hash, schema and completeness",
       "",
       "modebank verify robot.h5",
       {},
       {as_json(), {"repair", "", "of study folders: remove what is broken"}},
       run_verify},
  };
}

std::vector<Command> commands_about() {
  return {
      {"About",
       "help",
       "[COMMAND | SECTION | KEY | TERM]",
       "what a command, a key or a word of the summary means",
       "",
       "modebank help window.length",
       {},
       {as_json(), {"markdown", "", "all keys as a table"}},
       nullptr},
      {"About", "version", "", "version and revision", "", "modebank version", {}, {as_json()}, nullptr},
      {"About",
       "completion",
       "bash | zsh | fish",
       "completion for a shell, to be sourced",
       "",
       "source <(modebank completion bash)",
       {},
       {},
       run_completion},
      {"About", "manual", "[COMMAND]", "manual page in roff", "", "modebank manual run | man -l -", {}, {}, run_manual},
  };
}

}  // namespace

std::string CommandOption::typed() const {
  const std::string value = argument.empty() ? "" : " " + argument;
  const std::size_t comma = name.find(',');
  return (comma == std::string::npos ? "" : fmt::format("-{}{}, ", name.substr(comma + 1), value)) + "--" +
         long_name() + value;
}

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
  static const std::vector<CommandOption> options{{"help,h", "", "what a command does and reads"},
                                                  {"quiet,q", "", "errors only on standard error"},
                                                  {"verbose,v", "", "every candidate that was tried, too"},
                                                  {"version", "", "version and revision"}};
  return options;
}

void refuse_gone_command(const std::string& name) {
  if (name == "view")
    throw ConfigurationError(
        "view went; instead: `modebank report FOLDER -o SITE` writes an index and pages that open from disk");
}

const Command* find_command(const std::string& name) {
  const std::vector<Command>& table = command_table();
  const auto found = std::find_if(table.begin(), table.end(), [&](const Command& c) { return c.name == name; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace modebank::app
