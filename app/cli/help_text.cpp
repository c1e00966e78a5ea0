#include "app/cli/help_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/algorithm/string/trim.hpp>
#include <cctype>
#include <vector>

#include "app/cli/command_table.hpp"
#include "app/config/config.hpp"
#include "app/config/option_table.hpp"
#include "app/report/page/assets.hpp"
#include "app/text/terminal.hpp"
#include "ident/base/nearest_name.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

constexpr int help_width = 100;

/// Wraps the text into lines of at most `width` columns, without indentation.
std::vector<std::string> filled(const std::string& text, int width) {
  std::vector<std::string> lines = lines_of(wrapped(text, width));
  for (std::string& line : lines) boost::trim(line);
  return lines;
}

std::string default_of(const Option& option) {
  const std::string value = option.get(Config{});
  return value.empty() ? "empty" : value;
}

std::string option_text(const Option& option) {
  const std::string unit = option.unit.empty() ? "" : " [" + option.unit + "]";
  return fmt::format("  --{} {}{}\n", option.key, option.range, unit) +
         fmt::format("      {}\n",
                     fmt::join(filled(fmt::format("{} (default: {})", option.help, default_of(option)), help_width - 6),
                               "\n      "));
}

std::string when_text(const Option& option) {
  const std::string stage =
      option.stage ? fmt::format(" It changes the stage {} and those that follow.", name_of(*option.stage)) : "";
  return fmt::format("      {}\n",
                     fmt::join(filled("When to change it: " + option.when + "." + stage, help_width - 6), "\n      "));
}

/// A row of two columns. The text of the second column is wrapped within this column.
std::string row(const std::string& left, const std::string& right, std::size_t left_width) {
  std::string text;
  for (const std::string& line : filled(right, help_width - static_cast<int>(left_width) - 4))
    text += fmt::format("  {:<{}}  {}\n", text.empty() ? left : "", left_width, line);
  return text;
}

std::string heading_of(const Command& command) {
  return fmt::format("Usage: modebank {}{}{}{}{}\n\n", command.name, command.arguments.text.empty() ? "" : " ",
                     command.arguments.text, command.options.empty() ? "" : " [options]",
                     command.keys.empty() ? "" : " [--section.key value ...]");
}

std::string options_of(const Command& command) {
  std::string text = "\nOptions\n";
  std::size_t width = 0;
  for (const CommandOption& option : command.options) width = std::max(width, option.typed().size());
  for (const CommandOption& option : command.options) text += row(option.typed(), option.help, width);
  return command.options.empty() ? "" : text;
}

/// The most common keys, and the sections that contain all other keys.
std::string keys_paragraph(const Command& command) {
  if (command.keys.empty()) return "";
  constexpr std::size_t key_width = 23;
  std::string text;
  int count = 0;
  for (const Option& option : option_table())
    if (option.basic && command.reads(option.key) && ++count)
      text += row("--" + option.key, fmt::format("{} (default: {})", option.range, default_of(option)), key_width);
  constexpr int most_on_a_screen = 24;
  if (count > most_on_a_screen) text.clear();
  const std::string all = fmt::format("all of them: modebank help {}", fmt::join(command.keys, " "));
  return fmt::format("\nConfiguration keys, as options they win over the file\n{}  {}\n", text,
                     fmt::join(filled(all, help_width - 4), "\n    "));
}

std::string command_text(const Command& command) {
  const std::string details = command.details.empty() ? "" : " " + command.details;
  const std::string what = static_cast<char>(std::toupper(command.summary.front())) + command.summary.substr(1) + ".";
  return heading_of(command) + fmt::format("{}\n", fmt::join(filled(what + details, help_width), "\n")) +
         options_of(command) + keys_paragraph(command) + fmt::format("\nExample\n  {}\n", command.example);
}

std::string section_text(const std::string& section) {
  std::string text;
  for (const Option& option : option_table())
    if (option.section() == section) text += option_text(option);
  return text.empty() ? "" : fmt::format("[{}]\n{}", section, text);
}

using Terms = std::vector<nlohmann::json>;

/// The names of a term. With `not`, the words that are not used for this term.
std::vector<std::string> names_of_term(const nlohmann::json& entry, const char* member) {
  std::vector<std::string> names = entry.at(member);
  if (member == std::string("also")) names.push_back(entry.at("term"));
  return names;
}

/// The first entry that has a name for which `is` returns true; null if there is none.
template <class Is>
const nlohmann::json* find_term(const Terms& terms, const char* member, Is is) {
  for (const nlohmann::json& entry : terms)
    for (const std::string& name : names_of_term(entry, member))
      if (is(name)) return &entry;
  return nullptr;
}

std::string definition(const nlohmann::json& entry) {
  const std::vector<std::string> avoided = names_of_term(entry, "not");
  return fmt::format("{}: {}{}\n", entry.at("term").get<std::string>(), entry.at("means").get<std::string>(),
                     avoided.empty() ? "" : fmt::format(" Not called: {}.", fmt::join(avoided, ", ")));
}

/// The definition of a term; empty for other words. Words that are not used for a term also lead to its definition. The
/// exact spelling is tried first, because Q and q are two terms.
std::string term_text(const Terms& terms, const std::string& name) {
  const auto exactly = [&](const std::string& other) { return other == name; };
  const auto loosely = [&](const std::string& other) { return boost::algorithm::iequals(other, name); };
  const nlohmann::json* entry = find_term(terms, "also", exactly);
  if (!entry) entry = find_term(terms, "also", loosely);
  if (entry) return definition(*entry);
  entry = find_term(terms, "not", loosely);
  return entry ? fmt::format("\"{}\" is called {} here.\n{}", name, entry->at("term").get<std::string>(),
                             definition(*entry))
               : "";
}

nlohmann::json json_of(const Command& command) {
  nlohmann::json options = nlohmann::json::array();
  for (const CommandOption& option : command.options)
    options.push_back({{"name", option.long_name()},
                       {"argument", option.argument},
                       {"choices", option.choices()},
                       {"help", option.help}});
  return {{"name", command.name},       {"group", command.group},     {"arguments", command.arguments.text},
          {"summary", command.summary}, {"details", command.details}, {"example", command.example},
          {"keys", command.keys},       {"options", options}};
}

nlohmann::json json_of(const Option& option) {
  return {{"key", option.key},
          {"allowed", option.range},
          {"choices", option.choices()},
          {"unit", option.unit},
          {"default", option.get(Config{})},
          {"help", option.help},
          {"when", option.when},
          {"stage", option.stage ? name_of(*option.stage) : ""},
          {"basic", option.basic},
          {"repeatable", option.repeatable}};
}

}  // namespace

std::string help_overview() {
  std::string text = "Usage: modebank COMMAND [FILE...] [--section.key value ...]\n";
  std::string group;
  for (const Command& command : command_table()) {
    if (command.group != group) text += fmt::format("\n{}\n", command.group);
    group = command.group;
    text += row(command.name, command.summary, 10);
  }
  text += "\nEvery command has\n";
  for (const CommandOption& option : common_options()) text += row(option.typed(), option.help, 13);
  return text +
         "\n`modebank help X` explains a command, a section of the configuration, a key or a term.\n"
         "Exit status: 0 done; 1 a file's content is invalid, or the run failed; 2 usage, configuration or path.\n";
}

const Option* option_called(const std::string& words) {
  const std::vector<Option>& all = option_table();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Option& option) {
    return option.key == words || std::count(option.also.begin(), option.also.end(), words) > 0;
  });
  return found == all.end() ? nullptr : &*found;
}

std::string help_on(const std::string& name) {
  const Terms terms = nlohmann::json::parse(assets::terms_json());
  const std::string words = term_text(terms, name);
  if (const Command* command = find_command(name)) return command_text(*command) + (words.empty() ? "" : "\n" + words);
  if (const std::string text = words + section_text(name); !text.empty()) return text;
  if (const Option* option = option_called(name)) return option_text(*option) + when_text(*option);
  std::vector<std::string> known;
  for (const nlohmann::json& entry : terms) known.push_back(entry.at("term"));
  const std::string first = fmt::format("{}", fmt::join(known.begin(), known.begin() + 8, ", "));
  for (const Command& command : command_table()) known.push_back(command.name);
  for (const Option& option : option_table()) known.push_back(option.key);
  throw ConfigurationError(fmt::format("{} is no command, section, key or term{}; terms are {}, ...", name,
                                       did_you_mean(name, known), first));
}

nlohmann::json help_json() {
  nlohmann::json commands = nlohmann::json::array(), keys = nlohmann::json::array();
  for (const Command& command : command_table()) commands.push_back(json_of(command));
  for (const Option& option : option_table()) keys.push_back(json_of(option));
  return {{"commands", commands}, {"keys", keys}, {"terms", nlohmann::json::parse(assets::terms_json())}};
}

}  // namespace modebank::app
