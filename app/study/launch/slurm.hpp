#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Starts `modebank study CONFIG --study.stage run` through Slurm. The stages of a study do not depend on Slurm.
namespace modebank::app {

/// Content of a submission. All paths are absolute, because the tasks start on other machines.
struct SlurmRequest {
  std::filesystem::path program;  ///< path of this modebank program
  std::filesystem::path config;
  std::filesystem::path folder;  ///< folder of the study; its subfolder "slurm" contains scripts and logs
  std::filesystem::path data_root;
  std::vector<std::pair<std::string, std::string>> overrides;  ///< keys of the command line, in their order
  std::size_t tasks = 1;
  std::vector<std::string> options;  ///< more options of sbatch for the array, such as --partition=main or --time=60
};

/// The job scripts. Each runs one command line of modebank.
std::string run_script(const SlurmRequest& request);
std::string merge_script(const SlurmRequest& request);

struct SlurmSubmission {
  std::string array_job, merge_job;   ///< ids of the jobs
  std::vector<std::string> commands;  ///< commands that submitted these jobs
};

/// Throws ConfigurationError if PATH has no sbatch, or if a path has characters that Slurm interprets. Call this before
/// any file is written.
void check_request(const SlurmRequest& request);

/// Checks the request, writes both scripts, and submits the array and a merge job. The merge job starts when the array
/// has ended, even if tasks failed (afterany). If sbatch fails, throws DataError with the message of sbatch.
SlurmSubmission submit_to_slurm(const SlurmRequest& request);

}  // namespace modebank::app
