#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <random>
#include <thread>

#include "io/files/read_file.hpp"
#include "tests/app/study/study_fixture.hpp"

namespace modebank::test {
namespace {

/// A machine and how it sees a study's folder; see shared_mount.cpp.
struct Node {
  std::string name;
  int skew_s = 0;
};

constexpr const char* cache_s = "600";  // longer than any test, so that an error of caching would last to the end

/// The folder "backing". Machines with different clocks access it as "mount".
class SharedFileSystem : public StudyTest {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(file("backing"));
    std::filesystem::create_directory(file("mount"));
    MODEBANK_NEEDS(std::filesystem::exists(MODEBANK_SHARED_MOUNT),
                   "libfuse3 was absent when the tests were built: apt-get install libfuse3-dev");
    MODEBANK_NEEDS(can_mount(), "a file system cannot be mounted here: root, /dev/fuse and unshare are needed");
    const ProgramResult probe = run_program(on({"probe"}, {"/bin/true"}));
    ASSERT_EQ(probe.status, 0) << probe.err;
  }

  static bool can_mount() {
    const int device = ::open("/dev/fuse", O_RDWR | O_CLOEXEC);
    if (device >= 0) ::close(device);
    return device >= 0 && ::geteuid() == 0 &&
           run_program({"/usr/bin/env", "unshare", "--uts", "--pid", "--mount", "--fork", "true"}).status == 0;
  }
  std::vector<std::string> on(const Node& node, const std::vector<std::string>& command) const {
    std::vector<std::string> line{(project_dir() / "tests" / "support" / "node.sh").string(),
                                  node.name,
                                  MODEBANK_SHARED_MOUNT,
                                  file("backing").string(),
                                  file("mount").string(),
                                  cache_s,
                                  std::to_string(node.skew_s)};
    line.insert(line.end(), command.begin(), command.end());
    return line;
  }
  std::vector<std::string> study_on(const Node& node, const std::vector<std::string>& options = {}) const {
    return on(node, study_line("mount/study", six(options)));
  }
  /// Options for six runs with three mixtures.
  static std::vector<std::string> six(const std::vector<std::string>& options = {}) {
    std::vector<std::string> all{"--study.vary", "mixture.components = {1..3}",
                                 "--study.vary", "filter.variant = imm | salvi2025",
                                 "--study.jobs", "2"};
    all.insert(all.end(), options.begin(), options.end());
    return all;
  }
  std::string expected() const {
    const ProgramResult result = study(undisturbed, six());
    EXPECT_EQ(result.status, 0) << result.err;
    return numbers(undisturbed);
  }
  std::size_t in_log(const std::string& outcome) const {
    const std::string log = read_file(file(shared) / "log.csv");
    std::size_t found = 0;
    for (auto at = log.find(outcome); at != std::string::npos; at = log.find(outcome, at + 1)) ++found;
    return found;
  }
  static int runs_made(const std::string& output) {
    const auto at = output.find("\nrun       ");
    return at == std::string::npos ? 0 : std::atoi(output.c_str() + at + std::string("\nrun       ").size());
  }
  /// Sets the times of the machine's claims, as if it had not renewed them for eleven minutes.
  void age_claims(const std::string& host) const {
    std::error_code gone;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(file(shared))) {
      if (entry.path().extension() != ".claim") continue;
      std::ifstream claim(entry.path());
      std::string text;
      std::getline(claim, text);
      if (text.find("\"" + host + " ") != std::string::npos)
        std::filesystem::last_write_time(
            entry.path(), std::filesystem::last_write_time(entry.path(), gone) - std::chrono::minutes(11), gone);
    }
  }
  /// Checks that all archives on the server are complete, and that the table equals that of a single machine.
  void check(const std::string& numbers_expected) const {
    const ProgramResult verified = modebank({"verify", file(shared).string()});
    EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
    EXPECT_EQ(numbers(shared), numbers_expected);
  }

  static constexpr const char* shared = "backing/study";
};

/// Two machines with clocks twelve minutes apart start at the same time. Each run must be made only once.
TEST_F(SharedFileSystem, TwoMachinesAtOnceLeaveTheTableOfOne) {
  const std::string numbers_expected = expected();
  ProgramResult first, second;
  std::thread other([&] { second = run_program(study_on({"n2", -420})); });
  first = run_program(study_on({"n1", 300}));
  other.join();
  EXPECT_EQ(first.status, 0) << first.out << first.err;
  EXPECT_EQ(second.status, 0) << second.out << second.err;
  check(numbers_expected);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(file(shared)))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
  EXPECT_EQ(runs_made(first.out) + runs_made(second.out), 6) << "made twice though claims are seen";
}

/// This machine's cache says that a file is absent, but another machine has made it.
TEST_F(SharedFileSystem, AMergeSeesWhatAnotherMachineHasMade) {
  const std::string numbers_expected = expected();
  const std::string ready = file("ready").string(), made = file("made").string();
  std::vector<std::string> script{"/bin/sh",
                                  "-c",
                                  "ready=$1 made=$2; shift 2; \"$@\" --study.stage plan; \"$@\" --study.stage status; "
                                  "touch \"$ready\"; until [ -e \"$made\" ]; do sleep 0.05; done; "
                                  "exec \"$@\" --study.stage merge",
                                  "merge",
                                  ready,
                                  made};
  const std::vector<std::string> line = study_line("mount/study", six());
  script.insert(script.end(), line.begin(), line.end());
  Process merging(on({"n2"}, script));
  while (!std::filesystem::exists(ready) && merging.running())
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const ProgramResult run = run_program(study_on({"n1"}, {"--study.stage", "run"}));
  EXPECT_EQ(run.status, 0) << run.err;
  write("made", "");
  EXPECT_EQ(merging.wait(), 0);
  check(numbers_expected);
}

/// This must hold for any clocks of machines and files.
TEST_F(SharedFileSystem, FailuresAreTriedAgainWhateverTheClocksSay) {
  const auto failing = [&](const Node& node, std::vector<std::string> options) {
    options.insert(options.begin(), {"--study.vary", "window.length = 10 | 500"});
    return run_program(on(node, study_line("mount/study", options)));
  };
  EXPECT_EQ(failing({"n1"}, {}).status, 1);
  EXPECT_EQ(in_log(",failed,"), 1U);
  EXPECT_EQ(failing({"n2", 3600}, {}).status, 1);
  EXPECT_EQ(in_log(",failed,"), 2U) << "not tried again";
  EXPECT_EQ(failing({"n3", -3600}, {}).status, 1);
  EXPECT_EQ(in_log(",failed,"), 3U) << "not tried again";
}

int rounds() {
  const char* asked = std::getenv("MODEBANK_SHARED_FS_ROUNDS");
  return asked ? std::atoi(asked) : 1;
}

/// A machine is lost at a random change of the folder. The test sets its claims as if they had not been renewed for ten
/// minutes. Other machines then take them over. The lost machine's unfinished files stay.
TEST_F(SharedFileSystem, AMachineThatIsLostChangesNoNumber) {
  const std::string numbers_expected = expected();
  std::mt19937_64 generator(20261123);
  constexpr unsigned changes = 18;  // six trials: claim, archive, end of the claim
  for (int round = 0; round < rounds(); ++round) {
    std::filesystem::remove_all(file(shared));
    std::filesystem::create_directories(file(shared) / "trials");
    const std::string unfinished = std::string(shared) + "/trials/.key.h5.modebank-0123456789ab.tmp";
    write(unfinished, "half");
    const auto skew_s = [&] { return static_cast<int>(generator() % 1200) - 600; };
    Process lost(study_on({"n1", skew_s()}));
    Process other(study_on({"n2", skew_s()}));
    wait_for_changes(shared, static_cast<unsigned>(generator() % changes), lost);
    lost.kill_with_children();
    lost.wait();
    age_claims("n1");
    EXPECT_EQ(other.wait(), 0);
    EXPECT_EQ(run_program(study_on({"n3", skew_s()})).status, 0);
    EXPECT_EQ(read_file(file(unfinished)), "half");
    check(numbers_expected);
  }
}

}  // namespace
}  // namespace modebank::test
