#include "tests/support/slurm_cluster.hpp"

#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/support/run_program.hpp"

namespace modebank::test {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

bool holds(const std::string& environment, const std::string& setting) {
  return ('\0' + environment).find('\0' + setting + '\0') != std::string::npos;
}

pid_t parent_of(pid_t process) {
  const std::string stat = content_of(fs::path("/proc") / std::to_string(process) / "stat");
  std::istringstream fields(stat.substr(stat.rfind(')') + 1));
  char state = 0;
  pid_t parent = 0;
  fields >> state >> parent;
  return parent;
}

bool is_slurmstepd(pid_t process) {
  return content_of(fs::path("/proc") / std::to_string(process) / "comm").rfind("slurmstepd", 0) == 0;
}

}  // namespace

bool SlurmCluster::installed() {
  return std::system(
             "for p in sbatch slurmctld slurmd munged; do PATH=$PATH:/usr/sbin command -v $p || exit 1; done "
             ">/dev/null") == 0;
}

SlurmCluster::SlurmCluster(int nodes, int cpus_per_node) {
  // Ports that no other test's cluster uses. They lie below the kernel's range of dynamic ports.
  const int first_port = 12'000 + 16 * static_cast<int>(getpid() % 1'000);
  const ProgramResult started =
      run_program({"/bin/sh", script("slurm_up.sh"), folder_.path().string(), std::to_string(nodes),
                   std::to_string(cpus_per_node), std::to_string(first_port)});
  if (started.status != 0) {
    run_program({"/bin/sh", script("slurm_down.sh"), folder_.path().string()});
    throw std::runtime_error("Slurm did not start: " + started.out + started.err);
  }
  setenv("SLURM_CONF", (folder_.path() / "slurm.conf").c_str(), 1);
}

SlurmCluster::~SlurmCluster() {
  run_program({"/bin/sh", script("slurm_down.sh"), folder_.path().string()});
  unsetenv("SLURM_CONF");
}

std::string SlurmCluster::script(const std::string& name) {
  return (project_dir() / "tests" / "support" / name).string();
}

SlurmCluster::NodeProcesses SlurmCluster::processes_of(const std::string& node) const {
  const std::string configuration = "SLURM_CONF=" + (folder_.path() / "slurm.conf").string();
  NodeProcesses found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const pid_t process = std::atoi(entry.path().filename().c_str());
    if (process <= 0) continue;
    const std::string environment = content_of(entry.path() / "environ");
    if (!holds(environment, "SLURMD_NODENAME=" + node) || !holds(environment, configuration)) continue;
    found.tasks.insert(process);
    if (const pid_t parent = parent_of(process); is_slurmstepd(parent)) found.steps.insert(parent);
  }
  return found;
}

std::size_t SlurmCluster::running_on(const std::string& node) const { return processes_of(node).steps.size(); }

void SlurmCluster::kill_node(const std::string& node) const {
  const NodeProcesses processes = processes_of(node);
  kill(std::stoi(content_of(folder_.path() / "run" / ("slurmd." + node + ".pid"))), SIGKILL);
  for (const pid_t step : processes.steps) kill(step, SIGKILL);
  for (const pid_t task : processes.tasks) kill(task, SIGKILL);
}

std::string SlurmCluster::queue() const {
  return run_program({"squeue", "-h", "-r", "-t", "all", "-O", "JobArrayID:30,State:20,NodeList:20,RestartCnt:10"}).out;
}

}  // namespace modebank::test
