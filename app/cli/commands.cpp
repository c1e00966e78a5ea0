#include "app/cli/commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "app/chain/build_info.hpp"
#include "app/cli/command_table.hpp"
#include "app/cli/help_text.hpp"
#include "app/cli/log.hpp"
#include "app/cli/result.hpp"
#include "ident/base/nearest_name.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

void print_help(const CommandLine& line) {
  // `run --help` does the same as `help run`.
  std::vector<std::string> names = line.files;
  if (line.help) names.assign(!line.command.empty(), line.command);
  if (const std::string phrase = fmt::format("{}", fmt::join(names, " ")); option_called(phrase)) names = {phrase};
  std::string text;
  for (const std::string& name : names) text += help_on(name);
  print_text(line, names.empty() ? help_overview() : text);
  print_json(line, names.empty() ? help_json() : nlohmann::json{{"text", text}});
}

void print_version(const CommandLine& line) {
  print_text(line, fmt::format("modebank {} ({})\n", build_info::version, build_info::git_revision));
  print_json(line, {{"revision", build_info::git_revision}});
}

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
  else if (line.version)
    print_version(line);
  else if (const Command* command = find_command(line.command))
    return command->run(line);
  else
    refuse_command(line.command);
  return 0;
}

}  // namespace modebank::app
