#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string.hpp>

#include "app/cli/command_table.hpp"
#include "app/cli/commands.hpp"
#include "app/config/option_table.hpp"
#include "modebank/base/error.hpp"

/// Scripts that complete commands, options, keys and the words that a key may have, without starting the program.
namespace modebank::app {
namespace {

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const Command& command : command_table()) names.push_back(command.name);
  return names;
}

std::vector<std::string> options_of(const Command& command) {
  std::vector<std::string> names;
  for (const std::vector<CommandOption>* list : {&command.options, &common_options()})
    for (const CommandOption& option : *list) names.push_back("--" + option.long_name());
  for (const Option& option : option_table())
    if (command.reads(option.key)) names.push_back("--" + option.key);
  return names;
}

std::string bash_script() {
  std::string options, values;
  for (const Command& command : command_table())
    options += fmt::format("    {}) words=\"{}\" ;;\n", command.name, fmt::join(options_of(command), " "));
  for (const Option& option : option_table())
    if (const auto words = option.choices(); !words.empty())
      values += fmt::format("    --{}) COMPREPLY=($(compgen -W \"{}\" -- \"$current\")); return ;;\n", option.key,
                            fmt::join(words, " "));
  return fmt::format(R"(# completion of modebank for bash
_modebank() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} words=
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "{0}" -- "$current"))
    return
  fi
  case $previous in
    help) COMPREPLY=($(compgen -W "{0}" -- "$current")); return ;;
    completion) COMPREPLY=($(compgen -W "bash zsh fish" -- "$current")); return ;;
{1}  esac
  [[ $current == -* ]] || {{ COMPREPLY=($(compgen -f -- "$current")); return; }}
  case ${{COMP_WORDS[1]}} in
{2}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o filenames -o bashdefault -F _modebank modebank
)",
                     fmt::join(command_names(), " "), values, options);
}

/// In single quotes of zsh and fish, for a description.
std::string quoted(std::string text) {
  boost::replace_all(text, "'", "");
  boost::replace_all(text, "[", "(");
  boost::replace_all(text, "]", ")");
  boost::replace_all(text, ":", ",");
  boost::replace_all(text, "\\", "");
  return text;
}

std::string zsh_script() {
  std::string commands, options;
  for (const Command& command : command_table()) {
    commands += fmt::format("    '{}:{}'\n", command.name, quoted(command.summary));
    options += fmt::format("    {})\n      options=(", command.name);
    for (const std::vector<CommandOption>* list : {&command.options, &common_options()})
      for (const CommandOption& option : *list)
        options += fmt::format("\n        '--{}:{}'", option.long_name(), quoted(option.help));
    for (const Option& option : option_table())
      if (command.reads(option.key)) options += fmt::format("\n        '--{}:{}'", option.key, quoted(option.help));
    options += ") ;;\n";
  }
  std::string values;
  for (const Option& option : option_table())
    if (const auto words = option.choices(); !words.empty())
      values += fmt::format("    --{}) compadd -- {}; return ;;\n", option.key, fmt::join(words, " "));
  return fmt::format(R"(#compdef modebank
# completion of modebank for zsh
_modebank() {{
  local -a commands options
  commands=(
{0}  )
  if (( CURRENT == 2 )); then
    _describe -t commands command commands
    return
  fi
  case ${{words[CURRENT-1]}} in
    help) _describe -t commands command commands; return ;;
    completion) compadd -- bash zsh fish; return ;;
{1}  esac
  if [[ ${{words[CURRENT]}} != -* ]]; then
    _files
    return
  fi
  case ${{words[2]}} in
{2}  esac
  _describe -t options option options
}}
compdef _modebank modebank
)",
                     commands, values, options);
}

std::string fish_script() {
  std::string text = "# completion of modebank for fish\n";
  for (const Command& command : command_table()) {
    text += fmt::format("complete -c modebank -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                        quoted(command.summary));
    const std::string within = fmt::format("complete -c modebank -n '__fish_seen_subcommand_from {}'", command.name);
    for (const CommandOption& option : command.options)
      text += fmt::format("{} -l {}{} -d '{}'\n", within, option.long_name(), option.argument.empty() ? "" : " -r",
                          quoted(option.help));
    for (const Option& option : option_table()) {
      if (!command.reads(option.key)) continue;
      const auto words = option.choices();
      text += fmt::format("{} -l {} -r{} -d '{}'\n", within, option.key,
                          words.empty() ? "" : fmt::format(" -f -a '{}'", fmt::join(words, " ")), quoted(option.help));
    }
  }
  for (const CommandOption& option : common_options())
    text += fmt::format("complete -c modebank -l {} -d '{}'\n", option.long_name(), quoted(option.help));
  return text;
}

}  // namespace

int run_completion(const CommandLine& line) {
  const std::string shell = line.files.size() == 1 ? line.files.front() : "";
  if (shell != "bash" && shell != "zsh" && shell != "fish")
    throw ConfigurationError("completion needs a shell: modebank completion bash | zsh | fish");
  fmt::print("{}", shell == "bash" ? bash_script() : shell == "zsh" ? zsh_script() : fish_script());
  return 0;
}

}  // namespace modebank::app
