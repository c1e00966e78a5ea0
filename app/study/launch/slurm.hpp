#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Slurm as a launcher of `modebank study CONFIG --study.stage run --study.shard i/n`, and as a second source of the
/// jobs' states. The stages themselves are independent of it.
namespace modebank::app {

/// Content of a submission. All paths are absolute, because tasks start on other machines.
struct SlurmRequest {
  std::filesystem::path program;  ///< this modebank program
  std::filesystem::path config;
  std::filesystem::path folder;  ///< folder of the study; scripts and logs go into its folder "slurm"
  std::filesystem::path data_root;
  std::vector<std::pair<std::string, std::string>> overrides;  ///< keys from the command line, in order
  int shards = 1;                                              ///< n of i/n
  std::vector<int> tasks;                                      ///< the values of i that are submitted, rising
  std::vector<std::string> options;  ///< further options of sbatch for the array: --partition=main, --time=60
};

/// The job scripts. Each runs one command line of modebank.
std::string run_script(const SlurmRequest& request);
std::string merge_script(const SlurmRequest& request);

/// Indices in the form of --array: "0-6" or "1,4-5".
std::string array_list(const std::vector<int>& tasks);

struct SlurmSubmission {
  std::string array_job, merge_job;   ///< ids of the jobs
  std::vector<std::string> commands;  ///< the commands that submitted them
};

/// Throws ConfigurationError when PATH has no sbatch, or when a path has characters that Slurm interprets. Call it
/// before anything is written.
void check_request(const SlurmRequest& request);

/// Checks the request, writes both scripts, and submits the array and a merge job. The merge job starts when the array
/// has ended, also after failures (afterany). The ids are stored in the study's folder. Throws DataError with sbatch's
/// message when sbatch fails.
SlurmSubmission submit_to_slurm(const SlurmRequest& request);

/// Tasks of one submission by state, as Slurm sees them now.
struct SlurmJobView {
  std::string job;                                  ///< id
  std::string role;                                 ///< run or merge
  std::string source;                               ///< squeue, sacct, or "" when neither lists the job
  std::vector<std::pair<std::string, int>> states;  ///< RUNNING 3, PENDING 4, ...
  std::vector<std::string> notes;                   ///< tasks that need the user: held, failed, out of time
};

/// The jobs submitted for a study, the last submission last. Empty without any. Never throws, even where Slurm is
/// absent or does not answer.
std::vector<SlurmJobView> slurm_view(const std::filesystem::path& folder);
std::string slurm_text(const std::vector<SlurmJobView>& jobs);

}  // namespace modebank::app
