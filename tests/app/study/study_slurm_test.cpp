#include <chrono>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include "tests/app/study/study_fixture.hpp"
#include "tests/support/slurm_cluster.hpp"

namespace modebank::test {
namespace {

#define MODEBANK_NEEDS_SLURM() \
  MODEBANK_NEEDS(SlurmCluster::installed(), "Slurm is absent: apt-get install slurmctld slurmd slurm-client munge")

/// A line of SlurmCluster::queue().
struct Task {
  std::string id, state, node;
  int restarts = 0;
};

std::vector<Task> tasks_of(const SlurmCluster& cluster) {
  std::istringstream lines(cluster.queue());
  std::vector<Task> tasks;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    Task task;
    fields >> task.id >> task.state;
    if (!(fields >> task.node)) continue;
    if (!(fields >> task.restarts)) {  // no node yet
      task.restarts = std::atoi(task.node.c_str());
      task.node.clear();
    }
    tasks.push_back(task);
  }
  return tasks;
}

class StudySlurm : public StudyTest {
 protected:
  /// Waits until nothing is pending or running any more, at most that long; false when it took longer.
  static bool settled(const SlurmCluster& cluster, double limit_s) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
    while (std::chrono::steady_clock::now() < end) {
      const std::vector<Task> tasks = tasks_of(cluster);
      const bool over = !tasks.empty() && std::all_of(tasks.begin(), tasks.end(), [](const Task& task) {
        return task.state == "COMPLETED" || task.state == "FAILED" || task.state == "CANCELLED";
      });
      if (over) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    return false;
  }
};

TEST_F(StudySlurm, TableEqualsTheLocalOne) {
  MODEBANK_NEEDS_SLURM();
  run_undisturbed();
  const SlurmCluster cluster(3, 2);
  const ProgramResult submitted = study("slurm", {"--study.stage", "submit", "--study.slurm_tasks", "6"});
  ASSERT_EQ(submitted.status, 0) << submitted.err;
  EXPECT_TRUE(std::regex_search(submitted.out, std::regex("sbatch --parsable --array=0-5 "))) << submitted.out;
  EXPECT_TRUE(std::regex_search(submitted.out, std::regex("--dependency=afterany:[0-9]+ "))) << submitted.out;
  ASSERT_TRUE(settled(cluster, 60)) << cluster.queue();
  std::set<std::string> nodes;
  for (const Task& task : tasks_of(cluster)) {
    EXPECT_EQ(task.state, "COMPLETED") << task.id;
    nodes.insert(task.node);
  }
  EXPECT_EQ(nodes, (std::set<std::string>{"n1", "n2", "n3"}));
  EXPECT_EQ(numbers("slurm"), numbers(undisturbed));
  const ProgramResult status = study("slurm", {"--study.stage", "status"});
  EXPECT_NE(status.out.find("6 completed"), std::string::npos) << status.out;
  const ProgramResult again = study("slurm", {"--study.stage", "submit"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.out.find("sbatch"), std::string::npos) << "nothing is left to submit: " << again.out;
}

/// A node dies as by a power cut while it works; its tasks start again on another one.
TEST_F(StudySlurm, LostNodeChangesNoNumber) {
  MODEBANK_NEEDS_SLURM();
  const std::vector<std::string> slow{"--mixture.bootstrap", "200"};
  ASSERT_EQ(study(undisturbed, slow).status, 0);
  const SlurmCluster cluster(3, 1);
  std::vector<std::string> options{"--study.stage", "submit", "--study.slurm_tasks", "3"};
  options.insert(options.end(), slow.begin(), slow.end());
  const ProgramResult submitted = study("slurm", options);
  ASSERT_EQ(submitted.status, 0) << submitted.err;
  const auto at_work = [&] {
    return cluster.running_on("n2") > 0 && std::filesystem::exists(file("slurm") / "trials") &&
           !archives("slurm").empty();
  };
  for (int tries = 0; !at_work() && tries < 600; ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ASSERT_TRUE(at_work()) << "n2 had nothing to do\n" << cluster.queue();
  cluster.kill_node("n2");
  EXPECT_LT(archives("slurm").size(), trials);
  ASSERT_TRUE(settled(cluster, 120)) << cluster.queue();
  int restarts = 0;
  for (const Task& task : tasks_of(cluster)) {
    EXPECT_EQ(task.state, "COMPLETED") << task.id;
    restarts += task.restarts;
  }
  EXPECT_GE(restarts, 1) << cluster.queue();
  EXPECT_EQ(numbers("slurm"), numbers(undisturbed));
}

}  // namespace
}  // namespace modebank::test
