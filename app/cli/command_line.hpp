#pragma once

#include <string>
#include <utility>
#include <vector>

namespace modebank::app {

/// The command line, split into words but not interpreted.
struct CommandLine {
  std::string command;                                         ///< empty: no command was given
  std::vector<std::string> files;                              ///< positional arguments after the command
  std::vector<std::pair<std::string, std::string>> overrides;  ///< configuration keys given as options, in order
  std::vector<std::string> given;                              ///< long names of all other options, in order
  std::string typed;                                           ///< the whole command line, for the provenance
  std::string program;  ///< "modebank" if the shell finds the program by this name, else the program's path

  // Values of the options. The table of commands explains each of them.
  bool help = false, version = false, quiet = false, verbose = false;
  bool json = false, csv = false, dry_run = false, force = false;
  std::string output, run, to, until;
  std::string form = "increment";
};

/// Returns the word, quoted for a shell.
std::string shell_quoted(const std::string& word);

/// Throws ConfigurationError for an unknown option (with the nearest known option), an option without its value, and an
/// option that the command does not have.
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace modebank::app
