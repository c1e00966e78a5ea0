#include <gtest/gtest.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "app/config/config_file.hpp"
#include "app/study/run/trial_runner.hpp"
#include "app/study/run/worker_pool.hpp"
#include "modebank/base/error.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using namespace modebank::app;

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Trials that share with `modebank run`'s own archives beside them.
class StudySharing : public CliTest {
 protected:
  StudySharing() { spdlog::set_level(spdlog::level::off); }
  ~StudySharing() override { spdlog::set_level(spdlog::level::info); }
  /// An archive's bytes without what says who made it and where it went: they depend on its content alone.
  std::string content(Archive archive) const {
    archive.provenance = {};
    archive.config.clear();
    write_archive(file("content.h5"), archive);
    return bytes_of(file("content.h5"));
  }
  std::string run_alone(const KeyValues& keys) const {
    std::vector<std::string> options;
    for (const auto& [key, value] : keys) {
      options.push_back("--" + key);
      options.push_back(value);
    }
    const ProgramResult result = run(options);
    EXPECT_EQ(result.status, 0) << result.err;
    return content(read_archive(archive()));
  }
  Config configured(const KeyValues& keys) const {
    Config trial = load_config(config(), keys);
    trial.study = {};
    return trial;
  }
};

/// Neighbours differ in a key of each stage in turn, and come back to what was before.
const std::vector<KeyValues> trials{
    {},
    {{"filter.variant", "salvi2025"}},
    {{"filter.variant", "kf"}},
    {},
    {{"filter.smooth", "false"}, {"filter.horizon", "1..3"}},
    {{"bank.theta", "mean"}},
    {{"bank.refine", "em"}, {"bank.max_iterations", "2"}, {"bank.folds", "1"}},
    {{"bank.refine", "em"}, {"bank.max_iterations", "2"}, {"bank.folds", "1"}, {"filter.noise", "adaptive"}},
    {{"bank.measurement_variance", "0.01"}},
    {{"mixture.components", "2"}},
    {{"mixture.components", "2"}, {"mixture.features", "parameters"}},
    // What merging modes cost is found by running the filter.
    {{"mixture.components", "3"}, {"bank.modes", "2"}},
    {{"mixture.components", "3"}, {"bank.modes", "2"}, {"filter.variant", "salvi2025"}},
    {{"mixture.components", "3"}, {"bank.modes", "2"}, {"filter.noise", "adaptive"}},
    {{"job.seed", "9"}},
    {{"window.loss", "cauchy"}},
    {{"window.length", "20"}, {"filter.noise", "adaptive"}},
    {{"data.rate_hz", "5"}},
    {{"data.train", "01"}, {"data.test", "00"}},
    {},
};

TEST_F(StudySharing, TrialsAreWhatRunWritesToTheBit) {
  std::filesystem::create_directory(file("cache"));
  const FileLocks locks(file("locks"));
  const StageCache cache(file("cache"), 100.0, locks);
  TrialRunner runner(&cache);
  std::vector<std::string> alone;
  for (const KeyValues& keys : trials) alone.push_back(run_alone(keys));
  for (std::size_t i = 0; i < trials.size(); ++i)
    EXPECT_TRUE(content(runner.run(configured(trials[i]), "")) == alone[i]) << "trial " << i;
  // Another process finds the windows in the cache.
  TrialRunner other(&cache);
  for (std::size_t i = trials.size(); i-- > 0;)
    EXPECT_TRUE(content(other.run(configured(trials[i]), "")) == alone[i]) << "trial " << i << " from the cache";
}

TEST_F(StudySharing, EveryStageReadsBackFromTheCacheToTheBit) {
  std::filesystem::create_directory(file("cache"));
  const FileLocks locks(file("locks"));
  const StageCache cache(file("cache"), 100.0, locks);
  const Config trial = configured({{"bank.refine", "em"}, {"bank.max_iterations", "2"}, {"bank.folds", "1"}});
  const Archive made = TrialRunner(nullptr).run(trial, "");
  Archive taken = made;
  const auto pass = [&](Stage stage, const std::function<Archive()>& part, const auto& take) {
    const auto never = [] { return ADD_FAILURE() << "computed", false; };
    cache.provide(
        stage, "inputs", [](Archive&&) { FAIL(); }, [] { return true; }, part);
    cache.provide(stage, "inputs", take, never, part);
  };
  pass(
      Stage::windows,
      [&] {
        Archive part;
        part.recording = made.recording;
        part.windows = made.windows;
        return part;
      },
      [&](Archive&& part) { taken.windows = std::move(part.windows); });
  pass(
      Stage::mixture,
      [&] {
        Archive part;
        part.mixture = made.mixture;
        return part;
      },
      [&](Archive&& part) { taken.mixture = std::move(part.mixture); });
  pass(
      Stage::bank,
      [&] {
        Archive part;
        part.bank = made.bank;
        part.unrefined = made.unrefined;
        return part;
      },
      [&](Archive&& part) {
        taken.bank = std::move(part.bank);
        taken.unrefined = std::move(part.unrefined);
      });
  EXPECT_TRUE(content(taken) == content(made));
}

TEST_F(StudySharing, TheCacheIsBounded) {
  std::filesystem::create_directory(file("cache"));
  const FileLocks locks(file("locks"));
  const auto bytes = [&] {
    double sum = 0.0;
    for (const auto& entry : std::filesystem::directory_iterator(file("cache")))
      sum += static_cast<double>(entry.file_size());
    return sum;
  };
  const StageCache cache(file("cache"), 0.3, locks);
  TrialRunner runner(&cache);
  for (const char* length : {"10", "11", "12", "13", "14", "15"})
    runner.run(configured({{"window.length", length}, {"filter.smooth", "false"}}), "");
  EXPECT_LE(bytes(), 0.3e6);
  EXPECT_GT(bytes(), 0.0);
}

/// A cache may be a folder on another disk that holds more; nothing of it is the cache's but files of stages.
TEST_F(StudySharing, TheCacheRemovesAndFollowsNothingOfOthers) {
  std::filesystem::create_directories(file("elsewhere/cache"));
  std::filesystem::create_directory_symlink("elsewhere/cache", file("cache"));
  const std::string theirs(400000, 'x'), key(64, '0');
  write("cache/mine.h5", theirs);
  write("cache/windows-notes.h5", theirs);
  write("elsewhere/linked.h5", "precious");
  std::filesystem::create_symlink("../linked.h5", file("cache") / ("bank-" + key + ".h5"));
  const auto before = std::filesystem::last_write_time(file("elsewhere/linked.h5"));
  const FileLocks locks(file("locks"));
  const StageCache cache(file("cache"), 0.3, locks);
  cache.provide(
      Stage::bank, key, [](Archive&&) { FAIL(); }, [] { return true; }, [] { return Archive{}; });
  TrialRunner runner(&cache);
  for (const char* length : {"10", "11", "12", "13", "14", "15"})
    runner.run(configured({{"window.length", length}, {"filter.smooth", "false"}}), "");
  EXPECT_EQ(bytes_of(file("elsewhere/cache/mine.h5")), theirs);
  EXPECT_EQ(bytes_of(file("elsewhere/cache/windows-notes.h5")), theirs);
  EXPECT_EQ(bytes_of(file("elsewhere/linked.h5")), "precious");
  EXPECT_EQ(std::filesystem::last_write_time(file("elsewhere/linked.h5")), before);
}

TEST_F(StudySharing, AFailedTrialLeavesNothingForTheNext) {
  TrialRunner runner(nullptr);
  EXPECT_THROW(runner.run(configured({{"window.length", "500"}}), ""), std::exception);
  EXPECT_TRUE(content(runner.run(configured({}), "")) == run_alone({}));
}

TEST_F(StudySharing, LocksHoldAmongProcessesAndEndWithThem) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const FileLocks locks(file("locks"));
    const FileLocks::Hold hold = locks.lock("a");
    static_cast<void>(::write(ready[1], "x", 1));
    for (;;) ::pause();
  }
  char signal = 0;
  ASSERT_EQ(::read(ready[0], &signal, 1), 1);
  const FileLocks locks(file("locks"));
  EXPECT_FALSE(locks.try_lock("a"));
  EXPECT_TRUE(locks.is_held_elsewhere("a"));
  EXPECT_TRUE(locks.try_lock("b"));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(locks.try_lock("a"));
}

constexpr double patience_s = 600.0;

TrialReport computed(std::string message = {}) {
  TrialReport report;
  report.outcome = TrialOutcome::computed;
  report.message = std::move(message);
  return report;
}

TEST(WorkerPools, ACrashEndsItsTrialOnly) {
  WorkerPool pool(2, 0.0, [](const WorkerPool::TellWaiting&) {
    return [](std::size_t trial) {
      if (trial == 1) ::raise(SIGKILL);
      return computed(std::string(trial, 'x'));
    };
  });
  std::size_t given = 0, finished = 0;
  std::string messages[6];
  while (finished < 6) {
    for (std::size_t worker = 0; worker < pool.size(); ++worker)
      if (pool.is_idle(worker) && given < 6) pool.give(worker, given++);
    if (const auto done = pool.wait(patience_s)) {
      ++finished;
      EXPECT_EQ(done->crashed, done->trial == 1);
      EXPECT_EQ(done->report.outcome == TrialOutcome::computed, !done->crashed);
      messages[done->trial] = done->report.message;
    }
  }
  EXPECT_NE(messages[1].find("signal 9"), std::string::npos) << messages[1];
  EXPECT_EQ(messages[5], "xxxxx");
}

/// One byte for each process that passes a point.
class Gate {
 public:
  Gate() { EXPECT_EQ(::pipe(ends_), 0); }
  ~Gate() { ::close(ends_[0]), ::close(ends_[1]); }
  Gate(const Gate&) = delete;
  Gate& operator=(const Gate&) = delete;
  void open() const { EXPECT_EQ(::write(ends_[1], "x", 1), 1); }
  void pass() const {
    char byte = 0;
    EXPECT_EQ(::read(ends_[0], &byte, 1), 1);
  }

 private:
  int ends_[2];
};

TEST(WorkerPools, AnOverrunEndsItsTrialOnly) {
  const Gate begun, leave;
  WorkerPool pool(2, 0.2, [&](const WorkerPool::TellWaiting& tell_waiting) {
    return [&, tell_waiting](std::size_t trial) {
      if (trial == 1) ::pause();
      tell_waiting(true);  // until its end, so that it has no limit
      begun.open();
      leave.pass();
      return computed();
    };
  });
  pool.give(0, 0);
  begun.pass();
  pool.give(1, 1);
  const auto overrun = pool.wait(patience_s);
  ASSERT_TRUE(overrun);
  EXPECT_EQ(overrun->trial, 1U);
  EXPECT_TRUE(overrun->crashed);
  EXPECT_NE(overrun->report.message.find("study.timeout_s = 0.2"), std::string::npos) << overrun->report.message;
  leave.open();
  const auto other = pool.wait(patience_s);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->trial, 0U);
  EXPECT_EQ(other->report.outcome, TrialOutcome::computed);
}

/// An answer that arrives in time counts, however late the parent looks at it.
TEST(WorkerPools, ABusyParentTakesNoAnswerForAnOverrun) {
  const Gate answered;
  WorkerPool pool(1, 0.01, [&](const WorkerPool::TellWaiting&) {
    return [&](std::size_t trial) {
      if (trial == 1) ::pause();
      answered.open();
      return computed();
    };
  });
  pool.give(0, 0);
  answered.pass();
  std::this_thread::sleep_for(std::chrono::milliseconds(1000));  // the parent's other work
  const auto done = pool.wait(patience_s);
  ASSERT_TRUE(done);
  EXPECT_EQ(done->report.outcome, TrialOutcome::computed) << done->report.message;
}

/// The limit is a second, so that a loaded machine does not stop a process for so long between two calls.
TEST(WorkerPools, WaitingForAnotherProcessIsNoTimeOfTheTrial) {
  constexpr double timeout_s = 1.0;
  const Gate begun, go_on;
  WorkerPool pool(2, timeout_s, [&](const WorkerPool::TellWaiting& tell_waiting) {
    return [&, tell_waiting](std::size_t trial) {
      tell_waiting(true);
      begun.open();
      go_on.pass();
      tell_waiting(false);
      if (trial == 1) ::pause();  // from here its own time runs
      return computed();
    };
  });
  for (const std::size_t trial : {0, 1}) pool.give(trial, trial);
  for (int i = 0; i < 2; ++i) begun.pass();
  EXPECT_FALSE(pool.wait(2.0 * timeout_s)) << "time that is waited for counts";
  for (int i = 0; i < 2; ++i) go_on.open();
  for (int i = 0; i < 2; ++i) {
    const auto done = pool.wait(patience_s);
    ASSERT_TRUE(done);
    EXPECT_EQ(done->report.outcome, done->trial == 0 ? TrialOutcome::computed : TrialOutcome::failed)
        << done->report.message;
  }
}

TEST_F(StudySharing, TheCacheTellsOfWaitingForAnotherProcess) {
  std::filesystem::create_directory(file("cache"));
  const std::string stem = "bank-inputs";
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const FileLocks locks(file("locks"));
    const FileLocks::Hold hold = locks.lock(stem);
    static_cast<void>(::write(ready[1], "x", 1));
    for (;;) ::pause();
  }
  char signal = 0;
  ASSERT_EQ(::read(ready[0], &signal, 1), 1);
  const FileLocks locks(file("locks"));
  std::vector<bool> told;
  const StageCache cache(file("cache"), 1.0, locks, [&](bool waiting) {
    told.push_back(waiting);
    if (waiting) ::kill(child, SIGKILL);
  });
  const auto provide = [&] {
    cache.provide(
        Stage::bank, "inputs", [](Archive&&) {}, [] { return false; }, [] { return Archive{}; });
  };
  provide();
  EXPECT_EQ(told, (std::vector<bool>{true, false}));
  ::waitpid(child, nullptr, 0);
  provide();  // nobody is at it now
  EXPECT_EQ(told.size(), 2u);
}

}  // namespace
}  // namespace modebank::test
