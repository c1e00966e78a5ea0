#pragma once

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "app/cli/command_line.hpp"

namespace modebank::app {

/// Destination of an option's value: a member of CommandLine, or the configuration key that the option sets.
using OptionTarget = std::variant<bool CommandLine::*, std::string CommandLine::*, std::string>;

/// An option of a command that is not a configuration key.
struct CommandOption {
  std::string name;      ///< name without dashes; "output,o" also has the short form -o
  std::string argument;  ///< name of the value, or its choices ("increment | full"); empty for an option without a
                         ///< value
  std::string help;
  OptionTarget target;

  std::string long_name() const { return name.substr(0, name.find(',')); }
  std::string typed() const;                 ///< the option as in `help`, such as "-o FILE, --output FILE"
  std::vector<std::string> choices() const;  ///< allowed values; empty if any text is allowed
};

/// The files or words that follow a command's name.
struct Arguments {
  std::string text;   ///< the arguments as `help` shows them
  std::string needs;  ///< error message for a wrong number of arguments, for example "needs one archive"
  std::size_t fewest, most;
};

/// One command. The parser, help and the check of options all use this table.
struct Command {
  std::string group;    ///< heading under which `help` lists it
  std::string name;     ///
  Arguments arguments;  ///
  std::string summary;  ///< one line
  std::string details;  ///< more sentences for `help`; may be empty
  std::string example;
  std::vector<std::string> keys;  ///< sections or single keys of the configuration that the command reads
  std::vector<CommandOption> options;
  int (*run)(const CommandLine&);
  std::vector<std::string> not_keys = {};  ///< keys in those sections that the command does not read

  bool reads(const std::string& key) const;
  const CommandOption* find_option(const std::string& long_name) const;
};

/// All commands, group by group.
const std::vector<Command>& command_table();

/// Options that every command has.
const std::vector<CommandOption>& common_options();

/// Returns null if no command has that name.
const Command* find_command(const std::string& name);

}  // namespace modebank::app
