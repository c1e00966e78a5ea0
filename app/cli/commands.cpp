#include "app/cli/commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>

#include "app/chain/build_info.hpp"
#include "app/cli/check/check_output.hpp"
#include "app/cli/command_table.hpp"
#include "app/cli/dry_run.hpp"
#include "app/cli/help_text.hpp"
#include "app/cli/log.hpp"
#include "app/cli/progress_meter.hpp"
#include "app/config/config_file.hpp"
#include "app/study/answers/study_json.hpp"
#include "app/study/study.hpp"
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

int run_check(const CommandLine& line) {
  const Config config = load_config(line.files.front(), line.overrides);
  validate(config);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, config.job.thread_count());
  const ProgressMeter meter(!line.quiet);
  const DataCheck check = check_data({data_options_of(config), config.window.length, config.window.intercept});
  const std::vector<std::string> findings = findings_of(check, config);
  print_text(line, check_text(check, findings));
  print_json(line, check_json(check, findings), check.unusable.empty() ? 0 : 1);
  if (!check.unusable.empty()) throw DataError("unusable as configured: " + unusable_text(check));
  return 0;
}

int run_study(const CommandLine& line) {
  const std::string& file = line.files.front();
  const Config config = load_config(file, line.overrides);
  if (line.dry_run) return print_result(line, dry_run(config, {config.study.output}));
  const auto say = [&](const std::string& text) { print_text(line, text); };
  const int status = do_study({config, file, line.overrides, line.typed, say});
  if (line.json) print_json(line, study_json(config.study.output), status);
  return status;
}

}  // namespace modebank::app
