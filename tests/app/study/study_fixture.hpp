#pragma once

#include <sys/types.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "tests/app/cli_fixture.hpp"

namespace modebank::test {

/// A study of 24 runs, each of some hundredths of a second, on the two small runs of CliTest; in one or several
/// folders.
class StudyTest : public CliTest {
 protected:
  StudyTest();

  std::vector<std::string> study_line(const std::string& folder, const std::vector<std::string>& options = {}) const;
  ProgramResult study(const std::string& folder, const std::vector<std::string>& options = {}) const;
  /// All numbers of a study's table, and all answers, as text that round-trips.
  std::string numbers(const std::string& folder) const;
  /// Archives of a study with final names, in byte order.
  std::vector<std::filesystem::path> archives(const std::string& folder) const;
  /// Kills a worker that holds a claim on a trial; false if there is none.
  bool kill_a_worker(const std::string& folder, std::mt19937_64& generator) const;

  /// The study without any disturbance, in a folder of its own.
  static constexpr const char* undisturbed = "undisturbed";
  void run_undisturbed() const;

  static constexpr std::size_t trials = 24;
};

/// A program in its own process group; its output is discarded.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments);
  ~Process();  ///< kills the group
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  void kill_alone() const;  ///< sends SIGKILL to the program, not to its children
  void kill_with_children() const;
  int wait();  ///< exit status; 128 + signal when killed

 private:
  pid_t child_;
  bool ended_ = false;
};

}  // namespace modebank::test
