#include "app/cli/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <boost/program_options.hpp>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <type_traits>
#include <variant>

#include "app/cli/command_table.hpp"
#include "app/config/config_file.hpp"
#include "app/config/faults.hpp"
#include "app/config/option_table.hpp"
#include "app/study/launch/shell.hpp"
#include "ident/base/nearest_name.hpp"
#include "modebank/base/error.hpp"

namespace po = boost::program_options;

namespace modebank::app {
namespace {

/// Adds each option only once: several commands may have an option that sets the same member.
std::map<std::string, CommandOption> all_options() {
  std::map<std::string, CommandOption> options;
  const auto add = [&](const std::vector<CommandOption>& more) {
    for (const CommandOption& option : more) options.try_emplace(option.long_name(), option);
  };
  add(common_options());
  for (const Command& command : command_table()) add(command.options);
  return options;
}

po::options_description describe_options(const std::map<std::string, CommandOption>& options, CommandLine& line) {
  po::options_description description;
  auto add = description.add_options();
  const auto bind = [&](const char* name, const auto& target) {
    if constexpr (std::is_same_v<decltype(target), const std::string&>)
      add(name, po::value<std::string>());
    else if constexpr (std::is_same_v<decltype(target), bool CommandLine::*const&>)
      add(name, po::bool_switch(&(line.*target)));
    else
      add(name, po::value(&(line.*target)));
  };
  for (const auto& entry : options) {
    const CommandOption& option = entry.second;
    std::visit([&](const auto& target) { bind(option.name.c_str(), target); }, option.target);
  }
  add("words", po::value<std::vector<std::string>>());
  for (const Option& option : option_table())
    add(option.key.c_str(), po::value<std::vector<std::string>>()->composing());  // if the option is given twice, the
                                                                                  // last value is used
  return description;
}

/// Sets the configuration keys that the options set. Throws if an option has a list of choices and its value is not
/// among these.
void take_values(const std::map<std::string, CommandOption>& options, const po::variables_map& values,
                 CommandLine& line) {
  for (const auto& [name, option] : options) {
    if (const auto* key = std::get_if<std::string>(&option.target); key && values.count(name))
      line.overrides.emplace_back(*key, values[name].as<std::string>());
    const std::vector<std::string> words = option.choices();
    if (words.empty() || !values.count(name)) continue;
    const auto& value = values[name].as<std::string>();
    if (std::find(words.begin(), words.end(), value) == words.end())
      throw ConfigurationError(
          fmt::format("--{} {}: allowed are {}{}", name, value, fmt::join(words, " and "), did_you_mean(value, words)));
  }
}

/// Whether the shell finds this program without a path.
bool is_in_path(const std::filesystem::path& program) {
  const char* const path = std::getenv("PATH");
  std::vector<std::string> folders;
  boost::split(folders, path == nullptr ? std::string() : std::string(path), boost::is_any_of(":"));
  for (const std::string& folder : folders) {
    std::error_code absent;
    const std::filesystem::path candidate = std::filesystem::path(folder) / program.filename();
    if (std::filesystem::exists(candidate, absent)) return std::filesystem::equivalent(candidate, program, absent);
  }
  return false;
}

std::string program_as_called(const std::string& typed) {
  const bool by_name = typed.find('/') == std::string::npos || is_in_path(typed);
  return by_name ? std::filesystem::path(typed).filename().string() : shell_quoted(typed);
}

/// All words after `--` are files.
const std::string end_of_options = "--";

bool takes_a_value(const po::options_description& description, const std::string& word) {
  if (word.rfind("--", 0) != 0 || word == end_of_options) return false;
  const po::option_description* option = description.find_nothrow(word.substr(2), false);
  return option && option->semantic()->max_tokens() > 0;
}

/// Whether the next word is another option. If it is, the present key lacks its value. A value may begin with dashes,
/// as in options of sbatch.
bool is_option(const po::options_description& description, const std::string& word) {
  const std::string key = word.substr(0, word.find('='));
  const std::string name = key.find('.') == std::string::npos ? word : key;
  return name.rfind("--", 0) == 0 && name != end_of_options && description.find_nothrow(name.substr(2), false);
}

/// Joins each key and its value into one word (--key=value), so that Boost accepts any value. An empty value stays a
/// separate word.
std::vector<std::string> joined_values(int argc, const char* const* argv, const po::options_description& description) {
  std::vector<std::string> words;
  const auto push = [&](const std::string& key, const std::string& value) {
    if (value.empty())
      words.insert(words.end(), {key, value});
    else
      words.push_back(key + "=" + value);
  };
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == end_of_options) {
      words.insert(words.end(), argv + i, argv + argc);
      break;
    }
    const auto equal_sign = word.find('=');
    if (word.rfind("--", 0) == 0 && equal_sign != std::string::npos)
      push(word.substr(0, equal_sign), word.substr(equal_sign + 1));
    else if (!takes_a_value(description, word))
      words.push_back(word);
    else if (i + 1 < argc && !is_option(description, argv[i + 1]))
      push(word, argv[++i]);
    else
      throw ConfigurationError(fmt::format("the required argument for option '{}' is missing", word));
  }
  return words;
}

/// The key of a command's output file, for a command without -o; empty if there is none.
std::string output_key(const Command& command) {
  for (const char* key : {"archive.output", "study.output", "simulate.output"})
    if (command.reads(key)) return key;
  return {};
}

/// Text that names the key to use if the command does not have this option.
std::string instead_of(const Command& command, const std::string& option) {
  const std::string key = option == "output" ? output_key(command) : "";
  return key.empty() ? "" : fmt::format("--{} PATH says where it writes; ", key);
}

/// Text with the options and keys that a command reads: "it reads --data.*, --track.filter".
std::string known_words(const Command& command) {
  std::vector<std::string> known;
  for (const CommandOption& each : command.options) known.push_back("--" + each.long_name());
  for (const std::string& keys : command.keys)
    known.push_back(keys.find('.') == std::string::npos ? "--" + keys + ".*" : "--" + keys);
  if (known.empty()) return "it has no options";
  const std::string but =
      command.not_keys.empty() ? "" : fmt::format(", but for --{}", fmt::join(command.not_keys, ", --"));
  return fmt::format("it reads {}{}", fmt::join(known, ", "), but);
}

/// Throws for options that the command does not read, such as "-o" and "--window.length x".
void refuse_unread(const Command& command, const CommandLine& line) {
  std::vector<std::string> unread;
  std::string instead;
  const auto add = [&](const std::string& option) {
    unread.push_back("--" + option);
    instead += instead_of(command, option);
  };
  for (const std::string& given : line.given)
    if (!command.find_option(given)) add(given);
  for (const auto& [key, value] : line.overrides)
    if (!command.reads(key)) add(key);
  if (!unread.empty())
    throw ConfigurationError(fmt::format("{0} does not read {1}; {2}{3} (modebank help {0})", command.name,
                                         fmt::join(unread, ", "), instead, known_words(command)));
}

/// Adds the words from the parser to the command line. Throws ConfigurationError with the words that the parser did not
/// recognise.
void take_words(const po::parsed_options& parsed, CommandLine& line) {
  Faults faults;
  for (const po::option& option : parsed.options)
    if (option.unregistered) {
      const std::string& word = option.original_tokens.at(0);
      const std::string name = word.substr(0, word.find('='));
      faults.add(fmt::format("unknown option {}{}", name, nearest_key_hint(name)));
    } else if (option.string_key.find('.') != std::string::npos) {
      line.overrides.emplace_back(option.string_key, option.value.at(0));
    } else if (option.position_key < 0) {
      line.given.push_back(option.string_key);
    }
  faults.refuse();
}

void check_command(const Command& command, const CommandLine& line) {
  refuse_unread(command, line);
  const auto& [text, needs, fewest, most] = command.arguments;
  if (!line.version && (line.files.size() < fewest || line.files.size() > most))
    throw ConfigurationError(fmt::format("{} {}, as in: {}", command.name, needs, command.example));
}

}  // namespace

std::string shell_quoted(const std::string& word) { return shell_word(word); }

CommandLine parse_command_line(int argc, const char* const* argv) {
  CommandLine line;
  for (int i = 0; i < argc; ++i) line.typed += (i ? " " : "") + shell_quoted(argv[i]);
  line.program = program_as_called(argc > 0 ? argv[0] : "modebank");
  const std::map<std::string, CommandOption> options = all_options();
  const po::options_description description = describe_options(options, line);
  po::positional_options_description positional;
  positional.add("words", -1);
  po::variables_map values;
  try {
    // Options must not be abbreviated. Otherwise a new key could change the meaning of an abbreviation.
    const int style = po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
    const po::parsed_options parsed = po::command_line_parser(joined_values(argc, argv, description))
                                          .options(description)
                                          .positional(positional)
                                          .style(style)
                                          .allow_unregistered()
                                          .run();
    take_words(parsed, line);
    po::store(parsed, values);
    po::notify(values);
  } catch (const po::error& error) {
    throw ConfigurationError(error.what());
  }
  if (values.count("words")) line.files = values["words"].as<std::vector<std::string>>();
  if (!line.files.empty()) {
    line.command = line.files.front();
    line.files.erase(line.files.begin());
  }
  if (const Command* command = find_command(line.command); command && !line.help) check_command(*command, line);
  take_values(options, values, line);
  return line;
}

}  // namespace modebank::app
