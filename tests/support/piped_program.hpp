#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/paths.hpp"

namespace modebank::test {

/// A program with pipes for its standard input and output, for tests that exchange lines with it.
class PipedProgram {
 public:
  explicit PipedProgram(const std::vector<std::string>& arguments);
  ~PipedProgram();  ///< kills the program if it is still running
  PipedProgram(const PipedProgram&) = delete;
  PipedProgram& operator=(const PipedProgram&) = delete;

  void write(const std::string& text);
  /// The next line of output without the newline; nullopt at the end of the output, or after ten minutes.
  std::optional<std::string> read_line();
  void close_input();
  void close_output();
  void send_signal(int signal) const;
  /// Exit status; 128 + signal number if the program was killed.
  int wait();
  std::string errors() const;

 private:
  TemporaryFolder folder_;
  pid_t child_ = -1;
  int to_ = -1, from_ = -1;
  std::string buffer_;
};

}  // namespace modebank::test
