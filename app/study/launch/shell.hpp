#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// One word of a POSIX shell command. It is in quotes only if needed.
std::string shell_word(const std::string& text);
std::string shell_command(const std::vector<std::string>& words);

/// Whether $PATH contains a program with this name.
bool in_path(const std::string& program);

struct ShellResult {
  int status = -1;  ///< exit status; -1 if the command was not started or was killed
  std::string out;
};

/// Runs a command line in /bin/sh. Returns its exit status and standard output.
ShellResult run_shell(const std::string& command);

}  // namespace modebank::app
