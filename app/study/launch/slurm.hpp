#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Slurm as a launcher of `modebank study CONFIG --study.stage run --study.shard i/n`, and as a second opinion on what
/// is under way. The stages themselves know nothing of it.
namespace modebank::app {

/// What is handed to Slurm. Every path absolute: tasks start on other machines.
struct SlurmRequest {
  std::filesystem::path program;  ///< this modebank
  std::filesystem::path config;
  std::filesystem::path folder;  ///< of the study; scripts and logs go into its folder "slurm"
  std::filesystem::path data_root;
  std::vector<std::pair<std::string, std::string>> overrides;  ///< keys from the command line, in order
  int shards = 1;                                              ///< n of i/n
  std::vector<int> tasks;                                      ///< which i are submitted, rising
  std::vector<std::string> options;  ///< further options of sbatch, for the array: --partition=main, --time=60
};

/// The job scripts; what they run is one command line of modebank each.
std::string run_script(const SlurmRequest& request);
std::string merge_script(const SlurmRequest& request);

/// "0-6" or "1,4-5": indices as --array takes them.
std::string array_list(const std::vector<int>& tasks);

struct SlurmSubmission {
  std::string array_job, merge_job;   ///< ids
  std::vector<std::string> commands;  ///< what was typed for the user
};

/// Throws ConfigurationError when there is no sbatch in PATH, or when a path holds what Slurm would take for something
/// else: before anything is written.
void check_request(const SlurmRequest& request);

/// Checks the request, writes both scripts, submits the array and a merge job that waits for its end however it ends
/// (afterany), and remembers the ids in the study's folder. Throws DataError with sbatch's message when it refuses.
SlurmSubmission submit_to_slurm(const SlurmRequest& request);

/// Tasks of one submission by state, as Slurm sees them now.
struct SlurmJobView {
  std::string job;                                  ///< id
  std::string role;                                 ///< run or merge
  std::string source;                               ///< squeue, sacct or "" when neither knows the job any more
  std::vector<std::pair<std::string, int>> states;  ///< RUNNING 3, PENDING 4, ...
  std::vector<std::string> notes;  ///< tasks that will not move by themselves: held, failed, out of time
};

/// The jobs submitted for a study, the last submission last. Empty without any; never throws for an absent or silent
/// Slurm.
std::vector<SlurmJobView> slurm_view(const std::filesystem::path& folder);
std::string slurm_text(const std::vector<SlurmJobView>& jobs);

}  // namespace modebank::app
