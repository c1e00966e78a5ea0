#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Ids of a study's Slurm jobs. They are in a file in the study's folder, with lines "role id" in the order of
/// submission.
namespace modebank::app {

struct SlurmJob {
  std::string role;  ///< "run" (the array) or "merge"
  std::string id;
};

std::filesystem::path slurm_folder(const std::filesystem::path& study);
void remember_job(const std::filesystem::path& study, const SlurmJob& job);
std::vector<SlurmJob> remembered_jobs(const std::filesystem::path& study);

}  // namespace modebank::app
