#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "io/archive/inspect.hpp"
#include "tests/app/study/study_fixture.hpp"

namespace modebank::test {
namespace {

class StudySurvival : public StudyTest {};

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// One part of a test with many repeats. The parts run in parallel.
class StudySurvivalPart : public StudySurvival, public ::testing::WithParamInterface<unsigned> {};

constexpr unsigned parts = 5;
INSTANTIATE_TEST_SUITE_P(Of5, StudySurvivalPart, ::testing::Range(0U, parts));

/// All parts together run ten studies. Each is killed three times at random moments, alternately with and without its
/// children. Children that survive work beside the next process. Runs that finished before a kill must not be made
/// again.
TEST_P(StudySurvivalPart, ThirtyKillsChangeNoNumber) {
  const Clock::time_point start = Clock::now();
  run_undisturbed();
  const double duration_s = seconds_since(start);
  const std::string expected = numbers(undisturbed);
  std::mt19937_64 generator(20261121 + GetParam());
  std::uniform_real_distribution<double> moment(0.0, duration_s);
  for (unsigned round = GetParam(); round < 10; round += parts) {
    const std::string folder = "killed_" + std::to_string(round);
    for (unsigned blow = 0; blow < 3; ++blow) {
      Process process(study_line(folder));
      std::this_thread::sleep_for(std::chrono::duration<double>(moment(generator) / (blow + 1)));
      if ((round + blow) % 2 == 0)
        process.kill_alone();
      else
        process.kill_with_children();
      process.wait();
      if (blow == 2) {
        const ProgramResult resumed = study(folder);
        ASSERT_EQ(resumed.status, 0) << resumed.err;
      }
    }
    EXPECT_EQ(numbers(folder), expected) << "round " << round;
    std::filesystem::remove_all(file(folder));
  }
}

/// Number of repeats of the 24 settings. In `make nightly` it is 42, which gives 1,008 trials.
std::string repeats() {
  const char* asked = std::getenv("MODEBANK_STUDY_REPEATS");
  return asked ? asked : "4";
}

/// Twenty workers of a running study are killed. Each of their trials is recorded as failed or is done by another
/// worker. The next study completes them. In the middle of the test, the study moves to another folder.
TEST_F(StudySurvival, TwentyKilledWorkersAndAMoveChangeNoNumber) {
  const std::vector<std::string> many{"--study.repeats", repeats(), "--study.jobs", "2"};
  const Clock::time_point start = Clock::now();
  ASSERT_EQ(study(undisturbed, many).status, 0);
  const double duration_s = seconds_since(start);
  std::mt19937_64 generator(20261127);
  constexpr int kills = 20;
  std::uniform_real_distribution<double> pause(0.0, 1.5 * duration_s / kills);
  int killed = 0;
  std::size_t before_the_move = 0;
  const auto kill_some = [&](const std::string& folder, int until) {
    Process process(study_line(folder, many));
    std::atomic<bool> over = false;
    std::thread waiter([&] { process.wait(), over = true; });
    while (killed < until && !over) {
      std::this_thread::sleep_for(std::chrono::duration<double>(pause(generator)));
      while (!over && !kill_a_worker(folder, generator)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      killed += !over;
    }
    if (!over) process.kill_alone();
    waiter.join();
  };
  // If all trials are done, one archive is removed, so that a worker has work and can be killed.
  while (killed < kills / 2) {
    kill_some("killed", kills / 2);
    if (killed < kills / 2) std::filesystem::remove(archives("killed").front());
  }
  before_the_move = archives("killed").size();
  std::filesystem::rename(file("killed"), file("moved"));
  while (killed < kills) {
    kill_some("moved", kills);
    if (killed < kills) std::filesystem::remove(archives("moved").front());
  }
  const ProgramResult resumed = study("moved", many);
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_GT(before_the_move, 0U);
  EXPECT_EQ(archives("moved").size(), archives(undisturbed).size());
  EXPECT_EQ(numbers("moved"), numbers(undisturbed));
  EXPECT_FALSE(std::filesystem::exists(file("killed")));
  for (const auto& entry : std::filesystem::directory_iterator(file("moved") / "trials"))
    EXPECT_NE(entry.path().extension(), ".claim") << entry.path();
}

/// A killed worker loses only one trial. The study continues and records this trial as failed.
TEST_F(StudySurvival, AKilledWorkerEndsItsTrialOnly) {
  const std::vector<std::string> slow{"--mixture.restarts", "60", "--study.jobs", "2"};
  std::mt19937_64 generator(1);
  ProgramResult result;
  std::thread runner([&] { result = study("one", slow); });
  while (!kill_a_worker("one", generator)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  runner.join();
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("23 done, 1 failed"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("its process was ended by signal 9"), std::string::npos) << result.out;
  const ProgramResult resumed = study("one", slow);
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_NE(resumed.out.find("1 runs made, 23 existed"), std::string::npos) << resumed.out;
}

ino_t identity(const std::filesystem::path& path) {
  struct stat about {};
  return stat(path.c_str(), &about) == 0 ? about.st_ino : 0;
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

/// All parts together flip 200 bits, one in each archive of a round, except in two archives. `verify` must name exactly
/// the damaged archives. The next `study` repeats only these, and the table is the same as before.
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
    const ProgramResult verified = modebank({"verify", file(undisturbed).string()});
    EXPECT_EQ(verified.status, 1);
    for (const auto& path : paths)
      EXPECT_NE(verified.out.find(path.stem().string()), std::string::npos) << path << "\n" << verified.out;
    const ProgramResult resumed = study(undisturbed);
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(numbers(undisturbed), expected);
    for (const auto& [path, inode] : before) EXPECT_EQ(identity(path), inode) << path << " was whole and done again";
    const ProgramResult mended = modebank({"verify", file(undisturbed).string()});
    EXPECT_EQ(mended.status, 0) << mended.out;
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

TEST_F(StudySurvival, ThreadsJobsAndShardsChangeNoNumber) {
  run_undisturbed();
  const std::string expected = numbers(undisturbed);
  for (const std::string threads : {"1", "2"})
    for (const std::string jobs : {"1", "2"}) {
      const std::string folder = "threads_" + threads + jobs;
      const ProgramResult result = study(folder, {"--job.threads", threads, "--study.jobs", jobs});
      ASSERT_EQ(result.status, 0) << result.err;
      EXPECT_EQ(numbers(folder), expected) << folder;
    }
  for (const int shards : {1, 7}) {
    const std::string folder = "shards_" + std::to_string(shards);
    for (int i = shards - 1; i >= 0; --i) {
      EXPECT_NE(study(folder, {"--study.stage", "merge"}).status, 0) << "complete before shard " << i;
      const ProgramResult result =
          study(folder, {"--study.stage", "run", "--study.shard", std::to_string(i) + "/" + std::to_string(shards)});
      ASSERT_EQ(result.status, 0) << result.err;
    }
    const ProgramResult merged = study(folder, {"--study.stage", "merge"});
    ASSERT_EQ(merged.status, 0) << merged.err;
    EXPECT_EQ(numbers(folder), expected) << folder;
  }
}

/// Every archive is made once and is never replaced.
TEST_F(StudySurvival, TwoProcessesShareOneStudy) {
  run_undisturbed();
  Process first(study_line("shared", {"--study.jobs", "1"})), second(study_line("shared", {"--study.jobs", "1"}));
  std::map<std::filesystem::path, ino_t> seen;
  int replaced = 0;
  std::atomic<bool> over = false;
  std::thread watcher([&] {
    while (!over) {
      if (std::filesystem::exists(file("shared") / "trials"))
        for (const auto& path : archives("shared"))
          if (const auto [found, fresh] = seen.emplace(path, identity(path)); !fresh)
            replaced += found->second != identity(path);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  const int first_status = first.wait(), second_status = second.wait();
  over = true;
  watcher.join();
  EXPECT_EQ(first_status, 0);
  EXPECT_EQ(second_status, 0);
  EXPECT_EQ(replaced, 0) << "archives done twice";
  EXPECT_EQ(numbers("shared"), numbers(undisturbed));
}

/// study.best.ini can be run unchanged. It gives the score that the study states.
TEST_F(StudySurvival, BestConfigurationGivesItsScoreAgain) {
  run_undisturbed();
  nlohmann::json best;
  const nlohmann::json answers = inspect(file(undisturbed) / "study.h5", "/answers/best");
  for (const nlohmann::json& row : answers.at("value"))
    if (row.at("score") == "bank_test_log_score") best = row;
  ASSERT_FALSE(best.is_null());
  const std::string config_file = (file(undisturbed) / "study.best.ini").string();
  const ProgramResult result = modebank({"run", config_file, "--archive.output", archive()});
  ASSERT_EQ(result.status, 0) << result.err;
  int found = 0;
  const nlohmann::json summary = inspect(archive(), "/evaluation/summary");
  for (const nlohmann::json& row : summary.at("value"))
    if (row.at("filter") == "bank" && row.at("run") == "*" && row.at("role") == "test") {
      EXPECT_EQ(row.at("log_score"), best.at("value"));
      ++found;
    }
  EXPECT_EQ(found, 1);
}

}  // namespace
}  // namespace modebank::test
