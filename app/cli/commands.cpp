#include "app/cli/commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/chain/build_info.hpp"
#include "app/cli/command_table.hpp"
#include "app/cli/help_text.hpp"
#include "app/cli/log.hpp"
#include "app/study/answers/verify_study.hpp"
#include "ident/base/nearest_name.hpp"
#include "io/archive/archive.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

void print_help(const CommandLine& line) {
  // `run --help` and `help run` are the same.
  std::vector<std::string> names = line.files;
  if (line.help) names.assign(!line.command.empty(), line.command);
  for (const std::string& name : names) fmt::print("{}", help_on(name));
  if (names.empty()) fmt::print("{}", line.markdown ? option_markdown() : help_overview());
}

void print_version() { fmt::print("modebank {} ({})\n", build_info::version, build_info::git_revision); }

[[noreturn]] void refuse_command(const std::string& name) {
  std::vector<std::string> names;
  for (const Command& command : command_table()) names.push_back(command.name);
  if (name.empty())
    throw ConfigurationError(
        "no command\n  modebank demo       a simulated robot on two grounds, from its log to a verdict\n"
        "  modebank init LOG   writes a configuration for your own log\n  modebank help       all commands");
  throw ConfigurationError(
      fmt::format("unknown command {}{}; commands are {}", name, did_you_mean(name, names), fmt::join(names, ", ")));
}

}  // namespace

int run_command(const CommandLine& line) {
  set_up_log(line.quiet ? Verbosity::quiet : line.verbose ? Verbosity::verbose : Verbosity::normal);
  if (line.help || line.command == "help")
    print_help(line);
  else if (line.version || line.command == "version")
    print_version();
  else if (const Command* command = find_command(line.command))
    return command->run(line);
  else
    refuse_command(line.command);
  return 0;
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
