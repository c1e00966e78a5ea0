#pragma once

#include <sys/types.h>

#include <set>
#include <string>

#include "tests/support/paths.hpp"

namespace modebank::test {

/// A real Slurm on this machine during the object's lifetime (slurm_up.sh), in its own folder. It has munged, slurmctld
/// and one slurmd for each of the nodes n1, n2, ... SLURM_CONF points to it. If Slurm does not start, throws
/// std::runtime_error with the logs of the daemons.
class SlurmCluster {
 public:
  SlurmCluster(int nodes, int cpus_per_node);
  ~SlurmCluster();
  SlurmCluster(const SlurmCluster&) = delete;
  SlurmCluster& operator=(const SlurmCluster&) = delete;

  /// Whether Slurm and munge are installed.
  static bool installed();

  /// Number of tasks that have started on a node.
  std::size_t running_on(const std::string& node) const;
  /// Kills a node in the same way as a power cut: SIGKILL to its slurmd, its job steps and their tasks.
  void kill_node(const std::string& node) const;

  /// squeue's output for all jobs, including finished jobs. Each job has one line: task, state, node, restarts.
  std::string queue() const;

 private:
  struct NodeProcesses {
    std::set<pid_t> steps, tasks;  ///< `steps`: processes named slurmstepd; `tasks`: the processes below them
  };
  NodeProcesses processes_of(const std::string& node) const;
  static std::string script(const std::string& name);
  TemporaryFolder folder_;
};

}  // namespace modebank::test
