#pragma once

#include <sys/types.h>

#include <set>
#include <string>

#include "tests/support/paths.hpp"

namespace modebank::test {

/// A real Slurm on this machine for as long as the object lives (slurm_up.sh): its own munged, slurmctld and one slurmd
/// per node n1, n2, ..., in a folder of its own. SLURM_CONF points to it meanwhile. Throws std::runtime_error with the
/// daemons' logs when it does not come up.
class SlurmCluster {
 public:
  SlurmCluster(int nodes, int cpus_per_node);
  ~SlurmCluster();
  SlurmCluster(const SlurmCluster&) = delete;
  SlurmCluster& operator=(const SlurmCluster&) = delete;

  /// Whether Slurm and munge are installed.
  static bool installed();

  /// How many tasks of jobs have started on a node.
  std::size_t running_on(const std::string& node) const;
  /// Kills a node as a power cut would: its slurmd, its job steps and their tasks, by SIGKILL.
  void kill_node(const std::string& node) const;

  /// What squeue prints of all jobs, also finished ones, a line each: task, state, node, restarts.
  std::string queue() const;

 private:
  struct NodeProcesses {
    std::set<pid_t> steps, tasks;  ///< slurmstepd, and what runs below it
  };
  NodeProcesses processes_of(const std::string& node) const;
  static std::string script(const std::string& name);
  TemporaryFolder folder_;
};

}  // namespace modebank::test
