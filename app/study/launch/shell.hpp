#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// One word of a POSIX shell command, in quotes only where needed.
std::string shell_word(const std::string& text);
std::string shell_command(const std::vector<std::string>& words);

/// Whether $PATH has a program of that name.
bool in_path(const std::string& program);

struct ShellResult {
  int status = -1;  ///< exit status; -1 when it could not be started or was killed
  std::string out;
};

/// Runs a command line in /bin/sh and collects its standard output.
ShellResult run_shell(const std::string& command);

}  // namespace modebank::app
