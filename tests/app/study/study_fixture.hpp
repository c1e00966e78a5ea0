#pragma once

#include <sys/types.h>

#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/app/cli_fixture.hpp"

namespace modebank::test {

/// A program in its own process group. Its output is discarded.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments);
  ~Process();  ///< kills the whole group
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  void kill_alone() const;  ///< sends SIGKILL only to the program, not to its children
  void kill_with_children() const;
  bool running() const;
  int wait();  ///< returns the exit status, or 128 + signal if the program was killed

 private:
  pid_t child_;
  bool ended_ = false;
};

/// A study of 24 runs on the two small runs of CliTest. Each run takes some hundredths of a second. There can be one or
/// several study folders.
class StudyTest : public CliTest {
 protected:
  StudyTest();

  std::vector<std::string> study_line(const std::string& folder, const std::vector<std::string>& options = {}) const;
  ProgramResult study(const std::string& folder, const std::vector<std::string>& options = {}) const;
  /// All numbers of a study's table and all answers as text, with all digits.
  std::string numbers(const std::string& folder) const;
  std::set<std::filesystem::path> files(const std::string& folder) const;
  /// Files of trials that have their final names, sorted by bytes.
  std::vector<std::filesystem::path> trial_files(const std::string& folder, const char* extension) const;
  std::vector<std::filesystem::path> archives(const std::string& folder) const { return trial_files(folder, ".h5"); }
  /// Waits until files came into a study's folder or left it so many times, or until the process has ended.
  void wait_for_changes(const std::string& folder, unsigned changes, const Process& process) const;
  /// Kills a worker while it makes the trial whose claim it holds, and after it has used the processor for `busy_ticks`
  /// (of 10 ms) on it. Returns false if there is none.
  bool kill_a_worker(const std::string& folder, std::mt19937_64& generator, long busy_ticks = 0) const;

  /// The folder of the study that nothing disturbs.
  static constexpr const char* undisturbed = "undisturbed";
  void run_undisturbed() const;

  static constexpr std::size_t trials = 24;
};

}  // namespace modebank::test
