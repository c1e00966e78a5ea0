#include <sys/stat.h>

#include <cstdint>
#include <map>
#include <random>

#include "io/files/read_file.hpp"
#include "tests/app/study/study_fixture.hpp"

namespace modebank::test {
namespace {

class StudySurvival : public StudyTest {};

/// One part of a test with many repeats. The parts run in parallel.
class StudySurvivalPart : public StudySurvival, public ::testing::WithParamInterface<unsigned> {};

constexpr unsigned parts = 5;
INSTANTIATE_TEST_SUITE_P(Of5, StudySurvivalPart, ::testing::Range(0U, parts));

/// All parts together run ten studies. Each is killed three times, at random changes of its folder, alternately with
/// and without its children. Children that survive work beside the next process. At last it moves to another folder.
TEST_P(StudySurvivalPart, ThirtyKillsChangeNoNumber) {
  run_undisturbed();
  const std::string expected = numbers(undisturbed);
  std::mt19937_64 generator(20261121 + GetParam());
  constexpr unsigned changes_of_trial = 3;  // claim, archive, end of the claim
  for (unsigned round = GetParam(); round < 10; round += parts) {
    const std::string folder = "killed_" + std::to_string(round);
    for (unsigned blow = 0; blow < 3; ++blow) {
      Process process(study_line(folder));
      wait_for_changes(folder, static_cast<unsigned>(generator() % (changes_of_trial * trials / (blow + 1))), process);
      if ((round + blow) % 2 == 0)
        process.kill_alone();
      else
        process.kill_with_children();
      process.wait();
    }
    const std::string moved = "moved_" + std::to_string(round);
    std::filesystem::rename(file(folder), file(moved));
    const ProgramResult resumed = study(moved);
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(numbers(moved), expected) << "round " << round;
    EXPECT_FALSE(std::filesystem::exists(file(folder)));
    EXPECT_TRUE(trial_files(moved, ".claim").empty());
    std::filesystem::remove_all(file(moved));
  }
}

/// Identity of a file. A file that is made again has another one.
ino_t identity(const std::filesystem::path& path) {
  struct stat about {};
  return stat(path.c_str(), &about) == 0 ? about.st_ino : 0;
}

/// A killed worker loses only one trial. The study continues and records this trial as failed.
TEST_F(StudySurvival, AKilledWorkerEndsItsTrialOnly) {
  const std::vector<std::string> slow{"--mixture.restarts", "60", "--study.jobs", "2"};
  std::mt19937_64 generator(1);
  Process process(study_line("one", slow));
  constexpr long has_begun_ticks = 2;  // a worker reports its trial before it computes
  while (process.running() && !kill_a_worker("one", generator, has_begun_ticks)) wait_for_changes("one", 1, process);
  EXPECT_EQ(process.wait(), 1);
  EXPECT_EQ(archives("one").size(), trials - 1);
  ASSERT_EQ(trial_files("one", ".failed").size(), 1U);
  EXPECT_NE(read_file(trial_files("one", ".failed").front()).find("signal 9"), std::string::npos);
  std::map<std::filesystem::path, ino_t> before;
  for (const auto& path : archives("one")) before[path] = identity(path);
  const ProgramResult resumed = study("one", slow);
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(archives("one").size(), trials);
  for (const auto& [path, inode] : before) EXPECT_EQ(identity(path), inode) << path << " was done again";
  EXPECT_TRUE(trial_files("one", ".failed").empty());
}

/// With small_disk.c preloaded, the disk accepts only a limited number of bytes.
TEST_F(StudySurvival, FullDiskIsSaidAndWorkGoesOnWhenThereIsSpace) {
  run_undisturbed();
  std::uintmax_t bytes = 0;
  for (const auto& path : archives(undisturbed)) bytes += std::filesystem::file_size(path);
  const auto left = static_cast<std::int64_t>(bytes / 2);
  write("left", std::string(reinterpret_cast<const char*>(&left), sizeof left));
  std::vector<std::string> line = study_line("small");
  line.insert(line.begin(), {"/usr/bin/env", std::string("LD_PRELOAD=") + MODEBANK_SMALL_DISK,
                             "SMALL_DISK_COUNTER=" + file("left").string()});
  const ProgramResult full = run_program(line);
  EXPECT_EQ(full.status, 1);
  EXPECT_NE(full.err.find("No space left on device"), std::string::npos) << full.err;
  std::map<std::filesystem::path, ino_t> finished;
  for (const auto& path : archives("small")) {
    EXPECT_EQ(modebank({"verify", path.string()}).status, 0) << path;
    finished[path] = identity(path);
  }
  EXPECT_GT(finished.size(), 0U);
  EXPECT_LT(finished.size(), trials);
  const ProgramResult resumed = study("small");
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(numbers("small"), numbers(undisturbed));
  for (const auto& [path, inode] : finished) EXPECT_EQ(identity(path), inode) << path << " was done again";
}

}  // namespace
}  // namespace modebank::test
