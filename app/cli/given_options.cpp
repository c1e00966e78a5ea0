#include "app/cli/given_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// The key that says where a command writes what it has no -o for; empty where it has none.
std::string output_key(const Command& command) {
  for (const char* key : {"archive.output", "study.output", "simulate.output"})
    if (command.reads(key)) return key;
  return {};
}

/// What it has in place of an option that it does not read.
std::string instead_of(const Command& command, const std::string& option) {
  const std::string key = option == "output" ? output_key(command) : "";
  return key.empty() ? "" : fmt::format("--{} PATH says where it writes; ", key);
}

/// "--data.*, --track.filter", and of the sections what is left out.
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

/// "-o" and "--window.length x" are refused alike where nothing would read them.
[[noreturn]] void refuse(const Command& command, const std::string& option) {
  throw ConfigurationError(fmt::format("{0} does not read --{1}; {2}{3} (modebank help {0})", command.name, option,
                                       instead_of(command, option), known_words(command)));
}

}  // namespace

void check_options(const Command& command, const CommandLine& line) {
  for (const std::string& given : line.given)
    if (!command.find_option(given)) refuse(command, given);
  for (const auto& [key, value] : line.overrides)
    if (!command.reads(key)) refuse(command, key);
}

}  // namespace modebank::app
