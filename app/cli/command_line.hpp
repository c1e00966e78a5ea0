#pragma once

#include <string>
#include <utility>
#include <vector>

namespace modebank::app {

/// What the user typed, split but not yet interpreted.
struct CommandLine {
  std::string command;                                         ///< empty: none given
  std::vector<std::string> files;                              ///< positional arguments after the command
  std::vector<std::pair<std::string, std::string>> overrides;  ///< configuration keys given as options, in order
  std::vector<std::string> given;                              ///< long names of all other options, in order
  std::string typed;                                           ///< the whole line, for provenance
  std::string program;  ///< as the user has to call it: modebank where the shell finds it, else its path

  // Values of the options; the table of commands tells what each means.
  bool help = false, version = false, quiet = false, verbose = false;
  bool json = false, dry_run = false, force = false;
  bool schema = false, markdown = false, repair = false, findings = false, apply = false, yes = false;
  std::string output, run, table, to;
  std::string form = "increment";
  std::string effort = "normal";
  double wheel_separation_m = 0.0, wheel_radius_m = 0.0;  ///< 0: not given
};

/// A word as a shell takes it.
std::string shell_quoted(const std::string& word);

/// Throws ConfigurationError for an unknown option (naming the nearest known one), one without its value and one that
/// the command does not read.
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace modebank::app
