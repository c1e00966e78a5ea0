#pragma once

#include <string>
#include <utility>
#include <vector>

namespace modebank::app {

/// Options of `export`.
struct ExportLine {
  std::string to;                                         ///< form
  std::string table;                                      ///< of form csv: its path in the archive
  double wheel_separation_m = 0.0, wheel_radius_m = 0.0;  ///< of form ros2; 0: not given
};

/// What the user typed, split but not yet interpreted.
struct CommandLine {
  std::string command;                                         ///< empty: none given
  std::vector<std::string> files;                              ///< positional arguments after the command
  std::vector<std::pair<std::string, std::string>> overrides;  ///< configuration keys given as options, in order
  std::vector<std::string> given;                              ///< long names of all other options, in order
  bool help = false;
  bool version = false;
  bool quiet = false;     ///< errors alone on standard error
  bool verbose = false;   ///< all that was tried, too
  bool dry_run = false;   ///< say what would be read and written, and stop
  bool schema = false;    ///< config: a JSON schema of the keys
  bool markdown = false;  ///< help: all keys as a table
  bool json = false;
  bool repair = false;             ///< verify: remove what is broken in study folders
  bool findings = false;           ///< check: what it finds, without settings to try
  bool apply = false;              ///< check: write what it suggests
  bool force = false;              ///< write though something speaks against it (init, demo, export)
  bool yes = false;                ///< init: ask nothing
  std::string run = {};            ///< whose rows `show` and `export` give; empty: all
  std::string form = "increment";  ///< of models that `show` prints: increment or full
  std::string
      output;  ///< -o: the file that `report`, `predict`, `init`, `export` or `check --apply` writes, demo's folder
  ExportLine exported;  ///< of `export` alone
  std::string typed;    ///< the whole line, for provenance
  std::string program;  ///< as the user has to call it: modebank where the shell finds it, else its path
};

/// A word as a shell takes it.
std::string shell_quoted(const std::string& word);

/// Throws ConfigurationError for an unknown option (naming the nearest known one), one without its value and one that
/// the command does not read.
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace modebank::app
