#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>

#include "io/files/read_file.hpp"
#include "tests/app/study/study_fixture.hpp"

namespace modebank::test {
namespace {

/// A machine as a study's folder looks from it; see shared_mount.cpp.
struct Node {
  std::string name, locks;
  int skew_s = 0;
};

constexpr const char* cache_s =
    "600";  // longer than any test: what a mount remembers by mistake it remembers to the end

/// One folder, "backing", that machines with clocks of their own see as "mount".
class SharedFileSystem : public StudyTest {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(file("backing"));
    std::filesystem::create_directory(file("mount"));
    MODEBANK_NEEDS(std::filesystem::exists(MODEBANK_SHARED_MOUNT),
                   "libfuse3 was absent when the tests were built: apt-get install libfuse3-dev");
    MODEBANK_NEEDS(can_mount(), "a file system cannot be mounted here: root, /dev/fuse and unshare are needed");
    const ProgramResult probe = run_program(on({"probe", "local"}, {"/bin/true"}));
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
                                  node.locks,
                                  cache_s,
                                  std::to_string(node.skew_s)};
    line.insert(line.end(), command.begin(), command.end());
    return line;
  }
  std::vector<std::string> study_on(const Node& node, const std::vector<std::string>& options = {}) const {
    return on(node, study_line("mount/study", six(options)));
  }
  /// Six runs of three mixtures.
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
  /// Seen on the server: all archives whole, the table that of one machine.
  void check(const std::string& numbers_expected) const {
    const ProgramResult verified = modebank({"verify", file(shared).string()});
    EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
    EXPECT_EQ(numbers(shared), numbers_expected);
  }

  static constexpr const char* shared = "backing/study";
};

class SharedFileSystems : public SharedFileSystem, public ::testing::WithParamInterface<const char*> {};

/// Two machines begin at once; their clocks are twelve minutes apart.
TEST_P(SharedFileSystems, TwoMachinesAtOnceLeaveTheTableOfOne) {
  const std::string numbers_expected = expected();
  ProgramResult first, second;
  std::thread other([&] { second = run_program(study_on({"n2", GetParam(), -420})); });
  first = run_program(study_on({"n1", GetParam(), 300}));
  other.join();
  EXPECT_EQ(first.status, 0) << first.out << first.err;
  EXPECT_EQ(second.status, 0) << second.out << second.err;
  check(numbers_expected);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(file(shared)))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
  if (GetParam() == std::string("shared")) {
    EXPECT_EQ(in_log(",done,"), 6U) << "made twice though locks are seen";
  }
}

INSTANTIATE_TEST_SUITE_P(Locks, SharedFileSystems, ::testing::Values("ENOLCK", "ENOSYS", "local", "shared"),
                         [](const auto& about) { return std::string(about.param); });

/// What this machine was told is absent, another one has made since.
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
  Process merging(on({"n2", "ENOLCK", 0}, script));
  for (int tries = 0; !std::filesystem::exists(ready) && tries < 12'000; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const ProgramResult run = run_program(study_on({"n1", "ENOLCK", 0}, {"--study.stage", "run"}));
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("no locks on this file system"), std::string::npos) << run.err;
  write("made", "");
  EXPECT_EQ(merging.wait(), 0);
  check(numbers_expected);
}

/// Which failures are older than an execution does not follow from times: here files seem to be of the next hour.
TEST_F(SharedFileSystem, FailuresAreTriedAgainWhateverTheClocksSay) {
  const auto failing = [&](const Node& node, std::vector<std::string> options) {
    options.insert(options.begin(), {"--study.vary", "window.length = 10 | 500"});
    return run_program(on(node, study_line("mount/study", options)));
  };
  const auto record = [&] {
    for (const auto& entry : std::filesystem::directory_iterator(file(shared) / "trials"))
      if (entry.path().extension() == ".failed") return read_file(entry.path());
    return std::string();
  };
  EXPECT_EQ(failing({"n1", "ENOLCK", 0}, {}).status, 1);
  const std::string first = record();
  EXPECT_NE(first.find("\nrecorded by "), std::string::npos) << first;
  EXPECT_EQ(failing({"n2", "ENOLCK", 3600}, {}).status, 1);
  const std::string second = record();
  EXPECT_NE(second, first) << "not tried again";
  EXPECT_EQ(failing({"n3", "ENOLCK", -3600}, {"--study.retry", "false"}).status, 1);
  EXPECT_EQ(record(), second) << "tried again";
}

int rounds() {
  const char* asked = std::getenv("MODEBANK_SHARED_FS_ROUNDS");
  return asked ? std::atoi(asked) : 1;
}

/// A machine is lost at any moment; what it was writing stays untouched, for nobody else can know that it is gone.
TEST_F(SharedFileSystem, AMachineThatIsLostChangesNoNumber) {
  const std::string numbers_expected = expected();
  std::mt19937_64 generator(20261123);
  const std::vector<std::string> locks{"ENOLCK", "local", "shared", "ENOSYS"};
  for (int round = 0; round < rounds(); ++round) {
    const std::string kind = locks[static_cast<std::size_t>(round) % locks.size()];
    std::filesystem::remove_all(file(shared));
    std::filesystem::create_directories(file(shared) / "trials");
    const std::string unfinished = std::string(shared) + "/trials/.key.h5.modebank-0123456789ab.tmp";
    write(unfinished, "half");
    const auto skew_s = [&] { return static_cast<int>(generator() % 1200) - 600; };
    Process lost(study_on({"n1", kind, skew_s()}));
    Process other(study_on({"n2", kind, skew_s()}));
    std::this_thread::sleep_for(std::chrono::milliseconds(generator() % 1500));
    lost.kill_with_children();
    lost.wait();
    EXPECT_EQ(other.wait(), 0) << kind;
    EXPECT_EQ(run_program(study_on({"n3", kind, skew_s()})).status, 0) << kind;
    EXPECT_EQ(read_file(file(unfinished)), "half");
    check(numbers_expected);
  }
}

}  // namespace
}  // namespace modebank::test
