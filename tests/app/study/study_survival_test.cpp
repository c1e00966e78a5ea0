#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
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
/// and without its children. Children that survive work beside the next process.
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
    const ProgramResult resumed = study(folder);
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(numbers(folder), expected) << "round " << round;
    std::filesystem::remove_all(file(folder));
  }
}

/// Number of repeats of the 24 settings. In `make nightly` it is 42, which gives 1,008 trials.
std::string repeats() {
  const char* asked = std::getenv("MODEBANK_STUDY_REPEATS");
  return asked ? asked : "4";
}

/// Twenty workers of a running study are killed, each while it makes a trial. Each of these trials is recorded as
/// failed or is done by another worker. The next study completes them. After ten kills, the study moves to another
/// folder.
TEST_F(StudySurvival, TwentyKilledWorkersAndAMoveChangeNoNumber) {
  const std::vector<std::string> many{"--study.repeats", repeats(), "--study.jobs", "2"};
  ASSERT_EQ(study(undisturbed, many).status, 0);
  const std::size_t all = archives(undisturbed).size();
  std::mt19937_64 generator(20261127);
  constexpr int kills = 10;
  const auto kill_some = [&](const std::string& folder) {
    for (int killed = 0; killed < kills;) {
      // If all trials are done, one archive is removed, so that a worker has work and can be killed.
      if (archives(folder).size() == all) std::filesystem::remove(archives(folder).front());
      Process process(study_line(folder, many));
      while (killed < kills && process.running()) {
        wait_for_changes(folder, static_cast<unsigned>(generator() % 10), process);
        killed += !archives(folder).empty() && kill_a_worker(folder, generator);
      }
      process.kill_alone();
      process.wait();
    }
  };
  kill_some("killed");
  EXPECT_GT(archives("killed").size(), 0U);
  std::filesystem::rename(file("killed"), file("moved"));
  kill_some("moved");
  const ProgramResult resumed = study("moved", many);
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(archives("moved").size(), all);
  EXPECT_EQ(numbers("moved"), numbers(undisturbed));
  EXPECT_FALSE(std::filesystem::exists(file("killed")));
  EXPECT_TRUE(trial_files("moved", ".claim").empty());
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

void flip_a_bit(const std::filesystem::path& path, std::mt19937_64& generator) {
  std::fstream stream(path, std::ios::in | std::ios::out | std::ios::binary);
  const auto at = static_cast<std::streamoff>(generator() % std::filesystem::file_size(path));
  stream.seekg(at);
  char byte = 0;
  stream.get(byte);
  stream.seekp(at);
  stream.put(static_cast<char>(byte ^ static_cast<char>(1U << (generator() % 8))));
}

/// All parts together flip 200 bits, one in each archive of a round, except in two archives. `verify` must refuse the
/// damaged archives. The next `study` repeats only these, and the table is the same as before.
TEST_P(StudySurvivalPart, TwoHundredFlippedBitsAreFoundAndRedone) {
  constexpr int flips_of_part = 200 / parts;
  run_undisturbed();
  const std::string expected = numbers(undisturbed);
  std::mt19937_64 generator(7 + GetParam());
  int flips = 0;
  while (flips < flips_of_part) {
    std::vector<std::filesystem::path> paths = archives(undisturbed);
    std::shuffle(paths.begin(), paths.end(), generator);
    const std::vector<std::filesystem::path> whole(paths.end() - 2, paths.end());
    paths.resize(std::min<std::size_t>(paths.size() - 2, static_cast<std::size_t>(flips_of_part - flips)));
    std::map<std::filesystem::path, ino_t> before;
    for (const auto& path : whole) before[path] = identity(path);
    for (const auto& path : paths) flip_a_bit(path, generator);
    flips += static_cast<int>(paths.size());
    for (const auto& path : paths) EXPECT_EQ(modebank({"verify", path.string()}).status, 1) << path;
    const ProgramResult resumed = study(undisturbed);
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(numbers(undisturbed), expected);
    for (const auto& [path, inode] : before) EXPECT_EQ(identity(path), inode) << path << " was whole and done again";
    for (const auto& path : paths) EXPECT_EQ(modebank({"verify", path.string()}).status, 0) << path;
  }
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
