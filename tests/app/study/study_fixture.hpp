#pragma once

#include <sys/types.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "tests/app/cli_fixture.hpp"

namespace modebank::test {

/// A study of 24 runs of some hundredths of a second each on the two small runs of CliTest, in one or several folders.
class StudyTest : public CliTest {
 protected:
  StudyTest();

  std::vector<std::string> study_line(const std::string& folder, const std::vector<std::string>& options = {}) const;
  ProgramResult study(const std::string& folder, const std::vector<std::string>& options = {}) const;
  /// Every number of the table of a study's folder, and every answer, as text that round-trips.
  std::string numbers(const std::string& folder) const;
  /// Archives of a study under their final names, in byte order.
  std::vector<std::filesystem::path> archives(const std::string& folder) const;
  /// Kills a worker that is at a trial, as its claim names it; false where none is.
  bool kill_a_worker(const std::string& folder, std::mt19937_64& generator) const;

  /// The study done without any trouble, in a folder of its own.
  static constexpr const char* undisturbed = "undisturbed";
  void run_undisturbed() const;

  static constexpr std::size_t trials = 24;
};

/// A program in a process group of its own, its output thrown away.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments);
  ~Process();  ///< kills the group
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  void kill_alone() const;  ///< SIGKILL to the program itself, not to its children
  void kill_with_children() const;
  int wait();  ///< exit status; 128 + signal when killed

 private:
  pid_t child_;
  bool ended_ = false;
};

}  // namespace modebank::test
