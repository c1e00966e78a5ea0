#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Starts `modebank study CONFIG --study.stage run --study.shard i/n` through Slurm, and reads the states of the jobs
/// from Slurm. The stages of a study do not depend on Slurm.
namespace modebank::app {

/// Content of a submission. All paths are absolute, because the tasks start on other machines.
struct SlurmRequest {
  std::filesystem::path program;  ///< path of this modebank program
  std::filesystem::path config;
  std::filesystem::path folder;  ///< folder of the study; its subfolder "slurm" contains scripts and logs
  std::filesystem::path data_root;
  std::vector<std::pair<std::string, std::string>> overrides;  ///< keys of the command line, in their order
  int shards = 1;                                              ///< the number n in i/n
  std::vector<int> tasks;                                      ///< the submitted values of i, increasing
  std::vector<std::string> options;  ///< more options of sbatch for the array, such as --partition=main or --time=60
};

/// The job scripts. Each runs one command line of modebank.
std::string run_script(const SlurmRequest& request);
std::string merge_script(const SlurmRequest& request);

/// Indices in the form of sbatch's --array: "0-6" or "1,4-5".
std::string array_list(const std::vector<int>& tasks);

struct SlurmSubmission {
  std::string array_job, merge_job;   ///< ids of the jobs
  std::vector<std::string> commands;  ///< commands that submitted these jobs
};

/// Throws ConfigurationError if PATH has no sbatch, or if a path has characters that Slurm interprets. Call this before
/// any file is written.
void check_request(const SlurmRequest& request);

/// Checks the request, writes both scripts, and submits the array and a merge job. The merge job starts when the array
/// has ended, even if tasks failed (afterany). The job ids are stored in the study's folder. If sbatch fails, throws
/// DataError with the message of sbatch.
SlurmSubmission submit_to_slurm(const SlurmRequest& request);

/// Tasks of one submission by their present state in Slurm.
struct SlurmJobView {
  std::string job;                                  ///< id
  std::string role;                                 ///< "run" or "merge"
  std::string source;                               ///< "squeue" or "sacct"; empty if neither lists the job
  bool answered = true;                             ///< whether squeue answered at all
  std::vector<std::pair<std::string, int>> states;  ///< number of tasks in each state: RUNNING 3, PENDING 4, ...
  std::vector<std::string> notes;                   ///< tasks that need the user's attention: held, failed, out of time
};

/// The jobs that were submitted for a study, in the order of submission. Empty without jobs. Never throws, even if
/// Slurm is absent or does not answer.
std::vector<SlurmJobView> slurm_view(const std::filesystem::path& folder);
std::string slurm_text(const std::vector<SlurmJobView>& jobs);

}  // namespace modebank::app
