#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <map>

#include "app/cli/command_table.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/help_text.hpp"
#include "app/config/option_table.hpp"
#include "modebank/base/error.hpp"

/// Makes shell scripts that complete commands, options, keys and allowed values without a start of the program.
namespace modebank::app {
namespace {

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const Command& command : command_table()) names.push_back(command.name);
  return names;
}

/// The text in single quotes, for a shell.
std::string quoted(std::string text) {
  boost::replace_all(text, "'", "");
  boost::replace_all(text, "[", "(");
  boost::replace_all(text, "]", ")");
  boost::replace_all(text, ":", ",");
  boost::replace_all(text, "\\", "");
  return text;
}

/// The words that `help` explains: commands, sections, keys and terms. Some contain blanks.
std::vector<std::string> help_topics() {
  std::vector<std::string> topics = command_names();
  for (const Option& option : option_table())
    for (const std::string& name : {option.section(), option.key})
      if (std::find(topics.begin(), topics.end(), name) == topics.end()) topics.push_back(name);
  for (const std::string& term : term_names()) topics.push_back(quoted(term));
  return topics;
}

/// A word that may follow a command: an option or a key that the command reads.
struct Word {
  std::string name;  ///< without dashes
  std::string help;
  bool takes_value = false;
  std::vector<std::string> choices = {};  ///< allowed values; empty if the value is free text
};

std::vector<Word> options_in(const std::vector<CommandOption>& options) {
  std::vector<Word> words;
  for (const CommandOption& option : options)
    words.push_back({option.long_name(), option.help, !option.argument.empty(), option.choices()});
  return words;
}

std::vector<Word> keys_of(const Command& command) {
  std::vector<Word> words;
  for (const Option& option : option_table())
    if (command.reads(option.key)) words.push_back({option.key, option.help, true, option.choices()});
  return words;
}

/// The options of the command, the options that all commands have, and the keys of the command.
std::vector<Word> words_after(const Command& command) {
  std::vector<Word> all = options_in(command.options);
  for (const std::vector<Word>& more : {options_in(common_options()), keys_of(command)})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// The branches of a completion script: one for each option and key with a list of allowed values. In `action`, {}
/// stands for these values.
std::string value_branches(fmt::format_string<std::string> action) {
  std::map<std::string, std::vector<std::string>> choices;
  for (const Command& command : command_table())
    for (const Word& word : words_after(command)) choices.emplace(word.name, word.choices);
  std::string text;
  for (const auto& [name, words] : choices)
    if (!words.empty())
      text +=
          fmt::format("    --{}) {}; return ;;\n", name, fmt::format(action, fmt::format("{}", fmt::join(words, " "))));
  return text;
}

std::string bash_script() {
  std::string options;
  for (const Command& command : command_table()) {
    options += fmt::format("    {}) words=\"", command.name);
    for (const Word& word : words_after(command)) options += (options.back() == '"' ? "--" : " --") + word.name;
    options += "\" ;;\n";
  }
  return fmt::format(R"(# completion of modebank for bash
_modebank() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} words=
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "{0}" -- "$current"))
    return
  fi
  case $previous in
    help)
      local IFS=$'\n'
      COMPREPLY=($(compgen -W '{3}' -- "$current"))
      COMPREPLY=("${{COMPREPLY[@]// /\\ }}")
      return ;;
    completion) COMPREPLY=($(compgen -W "bash zsh fish" -- "$current")); return ;;
{1}  esac
  [[ $current == -* ]] || {{ COMPREPLY=($(compgen -f -- "$current")); return; }}
  case ${{COMP_WORDS[1]}} in
{2}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o filenames -o bashdefault -F _modebank modebank
)",
                     fmt::join(command_names(), " "),
                     value_branches("COMPREPLY=($(compgen -W \"{}\" -- \"$current\"))"), options,
                     fmt::join(help_topics(), "\n"));
}

std::string zsh_script() {
  std::string commands, options;
  for (const Command& command : command_table()) {
    commands += fmt::format("    '{}:{}'\n", command.name, quoted(command.summary));
    options += fmt::format("    {})\n      options=(", command.name);
    for (const Word& word : words_after(command))
      options += fmt::format("\n        '--{}:{}'", word.name, quoted(word.help));
    options += ") ;;\n";
  }
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
    help) compadd -- '{3}'; return ;;
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
# Loaded by its name at the first completion, or sourced.
if [ "$funcstack[1]" = _modebank ]; then
  _modebank "$@"
else
  compdef _modebank modebank
fi
)",
                     commands, value_branches("compadd -- {}"), options, fmt::join(help_topics(), "' '"));
}

std::string fish_script() {
  std::string text = "# completion of modebank for fish\n";
  for (const Command& command : command_table()) {
    text += fmt::format("complete -c modebank -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                        quoted(command.summary));
    const std::string within = fmt::format("complete -c modebank -n '__fish_seen_subcommand_from {}'", command.name);
    for (const std::vector<Word>& words : {options_in(command.options), keys_of(command)})
      for (const Word& word : words)
        text += fmt::format("{} -l {}{}{} -d '{}'\n", within, word.name, word.takes_value ? " -r" : "",
                            word.choices.empty() ? "" : fmt::format(" -f -a '{}'", fmt::join(word.choices, " ")),
                            quoted(word.help));
  }
  for (const std::string& topic : help_topics())
    text += fmt::format("complete -c modebank -n '__fish_seen_subcommand_from help' -f -a \"'{}'\"\n", topic);
  for (const CommandOption& option : common_options())
    text += fmt::format("complete -c modebank -l {} -d '{}'\n", option.long_name(), quoted(option.help));
  return text;
}

}  // namespace

int run_completion(const CommandLine& line) {
  const std::string& shell = line.files.front();
  if (shell != "bash" && shell != "zsh" && shell != "fish")
    throw ConfigurationError("completion needs a shell: modebank completion bash | zsh | fish");
  fmt::print("{}", shell == "bash" ? bash_script() : shell == "zsh" ? zsh_script() : fish_script());
  return 0;
}

}  // namespace modebank::app
