#pragma once

#include <string>
#include <vector>

namespace modebank::test {

struct ProgramResult {
  int status = -1;  ///< exit status; 128 + signal number if the program was killed
  std::string out;
  std::string err;
};

/// Runs a program without a shell and waits for it.
ProgramResult run_program(const std::vector<std::string>& arguments);

}  // namespace modebank::test
