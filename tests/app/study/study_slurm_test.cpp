#include <chrono>
#include <cstdlib>
#include <fstream>
#include <random>
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

/// A line that SlurmCluster::queue() returns.
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
    if (!(fields >> task.restarts)) {  // the task has no node yet
      task.restarts = std::atoi(task.node.c_str());
      task.node.clear();
    }
    tasks.push_back(task);
  }
  return tasks;
}

class StudySlurm : public StudyTest {
 protected:
  static bool over(const SlurmCluster& cluster) {
    const std::vector<Task> tasks = tasks_of(cluster);
    return !tasks.empty() && std::all_of(tasks.begin(), tasks.end(), [](const Task& task) {
      return task.state == "COMPLETED" || task.state == "FAILED" || task.state == "CANCELLED";
    });
  }
  /// Waits until every job has ended. Returns false after half an hour.
  static bool settled(const SlurmCluster& cluster) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(30);
    while (std::chrono::steady_clock::now() < end) {
      if (over(cluster)) return true;
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
  EXPECT_TRUE(std::regex_search(submitted.out, std::regex("sbatch --parsable --job-name=run-slurm .*--array=0-5 ")))
      << submitted.out;
  EXPECT_TRUE(std::regex_search(submitted.out, std::regex("sbatch .*--dependency=afterany:[0-9]+ "))) << submitted.out;
  ASSERT_TRUE(settled(cluster)) << cluster.queue();
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

/// Workers on two nodes are killed. The remaining runs are then submitted again.
TEST_F(StudySlurm, KilledWorkersChangeNoNumber) {
  MODEBANK_NEEDS_SLURM();
  const char* asked = std::getenv("MODEBANK_STUDY_REPEATS");
  const std::vector<std::string> many{"--study.repeats", asked ? asked : "4"};
  ASSERT_EQ(study(undisturbed, many).status, 0);
  const SlurmCluster cluster(2, 2);
  std::vector<std::string> options{"--study.stage", "submit", "--study.slurm_tasks", "4"};
  options.insert(options.end(), many.begin(), many.end());
  ASSERT_EQ(study("slurm", options).status, 0);
  std::mt19937_64 generator(20261127);
  for (int kills = 0; kills < 20 && !over(cluster); std::this_thread::sleep_for(std::chrono::milliseconds(50)))
    kills += kill_a_worker("slurm", generator);
  ASSERT_TRUE(settled(cluster)) << cluster.queue();
  const ProgramResult status = study("slurm", {"--study.stage", "status"});
  EXPECT_NE(status.out.find(" failed"), std::string::npos) << "none was killed: " << status.out;
  const ProgramResult again = study("slurm", options);
  ASSERT_EQ(again.status, 0) << again.out << again.err;
  ASSERT_TRUE(settled(cluster)) << cluster.queue();
  EXPECT_EQ(numbers("slurm"), numbers(undisturbed));
}

/// Lines of the first code block after a heading of a documentation page.
std::vector<std::string> commands_below(const std::string& page, const std::string& heading) {
  std::ifstream stream(project_dir() / "docs" / page);
  std::vector<std::string> commands;
  bool below = false, in_block = false;
  for (std::string line; std::getline(stream, line);) {
    below = below || line == heading;
    if (below && line.rfind("```", 0) == 0) {
      if (in_block) break;
      in_block = true;
    } else if (in_block) {
      commands.push_back(line);
    }
  }
  return commands;
}

/// Runs a command in a folder. The shell finds the modebank of this build.
ProgramResult typed_in(const std::filesystem::path& folder, const std::string& command) {
  return run_program({"/bin/sh", "-c", "cd \"$1\" && PATH=$2:$PATH && eval \"$3\"", "sh", folder.string(),
                      std::filesystem::path(MODEBANK_PROGRAM).parent_path().string(), command});
}

/// The commands of the how-to, for a study whose name is in these commands. The paths contain characters that shells,
/// Slurm's lines and Slurm's patterns interpret differently.
class StudySlurmPaths : public StudySlurm {
 protected:
  std::filesystem::path odd_folder(const std::string& name) const {
    const std::filesystem::path folder = file(name);
    std::filesystem::create_directories(folder / "configs");
    for (const char* data : {"run_00.csv", "run_01.csv"})
      std::filesystem::copy_file(file(data), folder / "configs" / data);
    std::filesystem::copy_file(file("study.ini"), folder / "configs" / "study_ice.ini");
    return folder;
  }
};

TEST_F(StudySlurmPaths, TheHandbooksCommandsRunAsPrinted) {
  MODEBANK_NEEDS_SLURM();
  run_undisturbed();
  const std::filesystem::path folder = odd_folder("it's 100 %j %% \"odd\" $HOME");
  const std::vector<std::string> commands = commands_below("howto/slurm.md", "## Slurm");
  ASSERT_EQ(commands.size(), 2U);
  const SlurmCluster cluster(3, 2);
  const ProgramResult submitted = typed_in(folder, commands[0]);
  ASSERT_EQ(submitted.status, 0) << submitted.out << submitted.err;
  ASSERT_TRUE(settled(cluster)) << cluster.queue();
  for (const Task& task : tasks_of(cluster)) EXPECT_EQ(task.state, "COMPLETED") << task.id;
  const ProgramResult status = typed_in(folder, commands[1]);
  EXPECT_EQ(status.status, 0) << status.out << status.err;
  EXPECT_NE(status.out.find("24 done"), std::string::npos) << status.out;
  std::size_t logs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "study_ice.study" / "slurm"))
    logs += entry.path().extension() == ".log";
  EXPECT_EQ(logs, 25U) << "one of each task and of the merge";
  EXPECT_EQ(numbers(std::filesystem::relative(folder / "study_ice.study", file("")).string()), numbers(undisturbed));
}

TEST_F(StudySlurmPaths, AFolderWithALineBreakIsRefusedBeforeAnythingIsWritten) {
  MODEBANK_NEEDS_SLURM();
  const std::filesystem::path folder = odd_folder("line\ntouch pwned\n");
  const std::vector<std::string> commands = commands_below("howto/slurm.md", "## Slurm");
  ASSERT_EQ(commands.size(), 2U);
  const ProgramResult submitted = typed_in(folder, commands[0]);
  EXPECT_EQ(submitted.status, 2) << submitted.out << submitted.err;
  EXPECT_NE(submitted.err.find("contains a control character"), std::string::npos) << submitted.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "study_ice.study"));
}

/// A node is lost while it works, as after a power cut. Its tasks start again on another node.
TEST_F(StudySlurm, LostNodeChangesNoNumber) {
  MODEBANK_NEEDS_SLURM();
  const std::vector<std::string> slow{"--mixture.restarts", "60"};
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
  for (int tries = 0; !at_work() && tries < 12'000; ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ASSERT_TRUE(at_work()) << "n2 had nothing to do\n" << cluster.queue();
  cluster.kill_node("n2");
  EXPECT_LT(archives("slurm").size(), trials);
  ASSERT_TRUE(settled(cluster)) << cluster.queue();
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
