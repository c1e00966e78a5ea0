// Studies on a real Slurm of two nodes, which this test starts and ends.
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "tests/app/study/study_fixture.hpp"

namespace modebank::test {
namespace {

struct Task {
  std::string id, state, node;
};

class StudySlurm : public StudyTest {
 protected:
  static constexpr const char* nodes = "2";
  static constexpr const char* cpus_per_node = "1";

  void SetUp() override {
    MODEBANK_NEEDS(std::system("for p in sbatch slurmctld slurmd munged; do PATH=$PATH:/usr/sbin command -v $p || "
                               "exit 1; done >/dev/null") == 0,
                   "Slurm is absent: apt-get install slurmctld slurmd slurm-client munge");
    // Ports that no other test's cluster uses. They lie below the kernel's range of dynamic ports.
    const int first_port = 12'000 + 16 * static_cast<int>(getpid() % 1'000);
    const ProgramResult started = run_program(
        {"/bin/sh", script("slurm_up.sh"), cluster_.path().string(), nodes, cpus_per_node, std::to_string(first_port)});
    ASSERT_EQ(started.status, 0) << started.out << started.err;
    setenv("SLURM_CONF", (cluster_.path() / "slurm.conf").c_str(), 1);
  }
  void TearDown() override {
    run_program({"/bin/sh", script("slurm_down.sh"), cluster_.path().string()});
    unsetenv("SLURM_CONF");
  }

  static std::string script(const std::string& name) { return (project_dir() / "tests" / "support" / name).string(); }
  /// All tasks, including finished ones.
  static std::vector<Task> tasks() {
    std::istringstream lines(
        run_program({"squeue", "-h", "-r", "-t", "all", "-O", "JobArrayID:30,State:20,NodeList:20"}).out);
    std::vector<Task> found;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream fields(line);
      Task task;
      fields >> task.id >> task.state >> task.node;
      found.push_back(task);
    }
    return found;
  }
  /// Waits until every job has ended. Returns false after half an hour.
  static bool settled() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(30);
    while (std::chrono::steady_clock::now() < end) {
      const std::vector<Task> now = tasks();
      if (!now.empty() && std::all_of(now.begin(), now.end(), [](const Task& task) {
            return task.state == "COMPLETED" || task.state == "FAILED" || task.state == "CANCELLED";
          }))
        return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    return false;
  }

 private:
  TemporaryFolder cluster_;
};

/// 24 runs are three tasks on two nodes, and a merge follows them. A task is stopped while it works and starts again,
/// as after the loss of its node.
TEST_F(StudySlurm, ARequeuedTaskChangesNoNumber) {
  const std::vector<std::string> slow{"--mixture.restarts", "60"};
  ASSERT_EQ(study(undisturbed, slow).status, 0);
  std::vector<std::string> options{"--study.stage", "submit"};
  options.insert(options.end(), slow.begin(), slow.end());
  const ProgramResult submitted = study("slurm", options);
  ASSERT_EQ(submitted.status, 0) << submitted.err;
  const auto first_running = [] {
    for (const Task& task : tasks())
      if (task.state == "RUNNING") return task.id;
    return std::string();
  };
  std::string running;
  for (int tries = 0; tries < 12'000 && (archives("slurm").empty() || running.empty()); ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    running = first_running();
  }
  ASSERT_FALSE(running.empty()) << "no task works";
  ASSERT_LT(archives("slurm").size(), trials);
  ASSERT_EQ(run_program({"scontrol", "requeue", running}).status, 0) << running;
  ASSERT_TRUE(settled());
  std::set<std::string> used;
  for (const Task& task : tasks()) {
    EXPECT_EQ(task.state, "COMPLETED") << task.id;
    used.insert(task.node);
  }
  EXPECT_EQ(used, (std::set<std::string>{"n1", "n2"}));
  EXPECT_EQ(numbers("slurm"), numbers(undisturbed));
}

}  // namespace
}  // namespace modebank::test
