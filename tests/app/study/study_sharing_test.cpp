#include <gtest/gtest.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "app/chain/stage_store.hpp"
#include "app/config/config_file.hpp"
#include "app/study/run/claim.hpp"
#include "app/study/run/study_worker.hpp"
#include "app/study/run/trial_runner.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using namespace modebank::app;

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Trials that share stages. Their archives must equal those of `modebank run`.
class StudySharing : public CliTest {
 protected:
  StudySharing() { spdlog::set_level(spdlog::level::off); }
  ~StudySharing() override { spdlog::set_level(spdlog::level::info); }
  /// The bytes of an archive without provenance and path. They depend only on its content.
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

/// Consecutive trials differ in a key of one stage after the other. At the end they return to earlier values.
const std::vector<KeyValues> trials{
    {},
    {{"filter.variant", "salvi2025"}},
    {{"filter.variant", "kf"}},
    {},
    {{"filter.horizon", "1..3"}},
    {{"bank.theta", "mean"}},
    {{"bank.refine", "em"}},
    {{"bank.measurement_variance", "0.01"}},
    {{"mixture.components", "2"}},
    {{"mixture.components", "2"}, {"mixture.features", "parameters"}},
    {{"job.seed", "9"}},
    {{"window.loss", "cauchy"}},
    {{"window.length", "20"}},
    {{"data.rate_hz", "5"}},
    {{"data.train", "01"}, {"data.test", "00"}},
    {},
};

TEST_F(StudySharing, TrialsAreWhatRunWritesToTheBit) {
  TrialRunner runner(file("cache"), 100.0, 0.0);
  std::vector<std::string> alone;
  for (const KeyValues& keys : trials) alone.push_back(run_alone(keys));
  for (std::size_t i = 0; i < trials.size(); ++i)
    EXPECT_TRUE(content(runner.run(configured(trials[i]), "")) == alone[i]) << "trial " << i;
  // Another process must find the stages in the store.
  TrialRunner other(file("cache"), 100.0, 0.0);
  for (std::size_t i = trials.size(); i-- > 0;)
    EXPECT_TRUE(content(other.run(configured(trials[i]), "")) == alone[i]) << "trial " << i << " from the store";
}

/// The store of `run` and of studies contains every stage up to a given last stage, except the data.
TEST_F(StudySharing, TheStoreKeepsTheStagesThatAreLaterUsed) {
  const Config trial = configured({{"bank.refine", "em"}});
  TrialRunner(file("cache"), 100.0, 0.0).run(trial, "");
  std::set<std::string> stages;
  for (const auto& entry : std::filesystem::directory_iterator(file("cache"))) {
    const std::string name = entry.path().filename();
    stages.insert(name.substr(0, name.find('-')));
  }
  // The configuration states the lags, so no structure is searched for. The bank's scores belong to only one trial.
  EXPECT_EQ(stages, (std::set<std::string>{"windows", "mixture", "competitors", "bank", "competitor_scores"}));
}

double bytes_in(const std::filesystem::path& folder) {
  double sum = 0.0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) sum += static_cast<double>(entry.file_size());
  return sum;
}

TEST_F(StudySharing, TheStoreIsBounded) {
  TrialRunner runner(file("cache"), 0.3, 0.0);
  for (const char* length : {"10", "11", "12", "13", "14", "15"})
    runner.run(configured({{"window.length", length}}), "");
  EXPECT_LE(bytes_in(file("cache")), 0.3e6);
  EXPECT_GT(bytes_in(file("cache")), 0.0);
}

/// The folder may be on another disk and contain other files. The store may only touch the files of stages.
TEST_F(StudySharing, TheStoreRemovesAndFollowsNothingOfOthers) {
  std::filesystem::create_directories(file("elsewhere/cache"));
  std::filesystem::create_directory_symlink("elsewhere/cache", file("cache"));
  const std::string theirs(400000, 'x'), key(64, '0');
  write("cache/mine.h5", theirs);
  write("cache/windows-notes.h5", theirs);
  write("elsewhere/linked.h5", "precious");
  std::filesystem::create_symlink("../linked.h5", file("cache") / ("bank-" + key + ".h5"));
  const auto before = std::filesystem::last_write_time(file("elsewhere/linked.h5"));
  StageStore store(file("cache"), {.worth_a_file_s = 0.0, .limit_mb = 0.3});
  const auto give = [] {
    Archive part;
    part.structure = FoundStructure{};
    part.structure->state_lags = 7;
    return part;
  };
  const auto take = [](Archive&& part) {
    ASSERT_TRUE(part.structure);  // the part from `give`, not the content of the link's target
    EXPECT_EQ(part.structure->state_lags, 7);
  };
  store.provide(Stage::bank, key, {[] {}, give, take});
  TrialRunner runner(file("cache"), 0.3, 0.0);
  for (const char* length : {"10", "11", "12", "13", "14", "15"})
    runner.run(configured({{"window.length", length}}), "");
  EXPECT_EQ(bytes_of(file("elsewhere/cache/mine.h5")), theirs);
  EXPECT_EQ(bytes_of(file("elsewhere/cache/windows-notes.h5")), theirs);
  EXPECT_EQ(bytes_of(file("elsewhere/linked.h5")), "precious");
  EXPECT_EQ(std::filesystem::last_write_time(file("elsewhere/linked.h5")), before);
}

TEST_F(StudySharing, AFailedTrialLeavesNothingForTheNext) {
  TrialRunner runner;
  EXPECT_THROW(runner.run(configured({{"window.length", "500"}}), ""), std::exception);
  EXPECT_TRUE(content(runner.run(configured({}), "")) == run_alone({}));
}

/// Claims on one file that this process and other processes take.
class Claims : public StudySharing {
 protected:
  /// Starts a process that takes the claim and keeps it until it is killed.
  pid_t holder() const {
    int ready[2];
    EXPECT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      const auto claim = Claim::take(path());
      static_cast<void>(::write(ready[1], claim ? "y" : "n", 1));
      for (;;) ::pause();
    }
    char taken = 0;
    EXPECT_EQ(::read(ready[0], &taken, 1), 1);
    EXPECT_EQ(taken, 'y');
    for (const int end : ready) ::close(end);
    return child;
  }
  static void end(pid_t process) {
    ::kill(process, SIGKILL);
    ::waitpid(process, nullptr, 0);
  }
  /// Makes the claim older by this time, according to the clock of its folder.
  void age(double seconds) const {
    namespace chrono = std::chrono;
    write_file(file("now"), "");
    const auto back =
        chrono::duration_cast<std::filesystem::file_time_type::duration>(chrono::duration<double>(seconds));
    std::filesystem::last_write_time(path(), std::filesystem::last_write_time(file("now")) - back);
  }
  /// Changes a value in an existing claim.
  void rewrite(const std::string& key, const nlohmann::json& value) const {
    auto claim = nlohmann::json::parse(bytes_of(path()));
    claim[key] = value;
    write_file(path(), claim.dump());
  }
  std::filesystem::path path() const { return file("a.claim"); }
};

TEST_F(Claims, HoldAmongProcessesAndEndWithThem) {
  const pid_t other = holder();
  EXPECT_FALSE(Claim::take(path()));
  EXPECT_TRUE(Claim::take(file("b.claim")));
  EXPECT_FALSE(std::filesystem::exists(file("b.claim"))) << "given up";
  end(other);
  EXPECT_TRUE(Claim::take(path()));
  EXPECT_EQ(left_behind(), std::vector<std::string>{});
}

/// If a process has the same number but another start time, the claim's process is gone.
TEST_F(Claims, AReusedProcessNumberIsNotTakenForTheHolder) {
  const pid_t other = holder();
  rewrite("start", 1);
  EXPECT_TRUE(Claim::take(path()));
  end(other);
}

/// For a process on another machine, only renewals of its claim show that it is alive.
TEST_F(Claims, OfOtherMachinesLastTenMinutesByTheFoldersClock) {
  end(holder());
  rewrite("host", "another machine");
  age(Claim::lasts_s - 30.0);
  EXPECT_FALSE(Claim::take(path()));
  age(Claim::lasts_s + 1.0);
  EXPECT_TRUE(Claim::take(path()));
}

/// The folder's clock was an hour ahead when another machine wrote its claim. Then the clock was corrected.
TEST_F(Claims, FromAClockThatWasSetBackEndToo) {
  end(holder());
  rewrite("host", "another machine");
  age(30.0 - Claim::lasts_s);
  EXPECT_FALSE(Claim::take(path()));
  age(-3600.0);
  EXPECT_TRUE(Claim::take(path()));
}

TEST_F(Claims, OfALivingProcessThatDoesNotRenewEndToo) {
  const pid_t other = holder();
  age(Claim::lasts_s + 1.0);
  {
    const auto mine = Claim::take(path());
    ASSERT_TRUE(mine);
    EXPECT_EQ(nlohmann::json::parse(bytes_of(path())).at("process"), ::getpid());
  }
  EXPECT_FALSE(std::filesystem::exists(path()));
  end(other);
}

/// If another process has taken over a claim, the first process must not remove the new claim.
TEST_F(Claims, AreRemovedByTheirHolderAlone) {
  {
    const auto mine = Claim::take(path());
    ASSERT_TRUE(mine);
    rewrite("process", 1);
  }
  EXPECT_TRUE(std::filesystem::exists(path()));
  Claim::end_of(::getpid(), path());
  EXPECT_TRUE(std::filesystem::exists(path()));
  Claim::end_of(1, path());
  EXPECT_FALSE(std::filesystem::exists(path()));
}

/// A file without a valid claim expires by its time. The target of a link stays unchanged.
TEST_F(Claims, OtherFilesOfTheNameDoNotStopAStudyForGood) {
  for (const char* text : {"", "half a li", "[1, 2]", R"({"host": 1, "process": "x", "start": []})"}) {
    write_file(path(), text);
    EXPECT_FALSE(Claim::take(path())) << text;
    age(Claim::lasts_s + 1.0);
    EXPECT_TRUE(Claim::take(path())) << text;
  }
  write_file(file("theirs"), "precious");
  std::filesystem::create_symlink(file("theirs"), path());
  EXPECT_TRUE(Claim::take(path()));
  EXPECT_EQ(bytes_of(file("theirs")), "precious");
}

}  // namespace
}  // namespace modebank::test
