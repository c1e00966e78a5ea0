#include "app/study/launch/slurm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>

#include "app/study/launch/shell.hpp"
#include "app/study/launch/slurm_jobs.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;

fs::path run_script_path(const SlurmRequest& request) { return slurm_folder(request.folder) / "run.sh"; }
fs::path merge_script_path(const SlurmRequest& request) { return slurm_folder(request.folder) / "merge.sh"; }

std::string study_command(const SlurmRequest& request, const std::string& stage) {
  std::vector<std::string> words{request.program.string(), "study", request.config.string()};
  for (const auto& [key, value] : request.overrides)
    if (key != "study.output" && key != "study.stage" && key != "study.shard" && key != "data.root")
      words.insert(words.end(), {"--" + key, value});
  words.insert(words.end(), {"--data.root", request.data_root.string(), "--study.output", request.folder.string(),
                             "--study.stage", stage});
  return shell_command(words);
}

/// What both scripts begin with. Logs are appended to, so that a task that was requeued keeps its first life's.
std::string script_head(const SlurmRequest& request, const std::string& role, const std::string& log) {
  const std::string name = request.folder.filename().string();
  return fmt::format(
      "#!/bin/bash\n"
      "# Written by: modebank study --study.stage submit\n"
      "#SBATCH --job-name={}-{}\n"
      "#SBATCH --requeue\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --chdir={}\n"
      "#SBATCH --output={}\n",
      role, boost::replace_all_copy(name, " ", "_"), fs::current_path().string(),
      (slurm_folder(request.folder) / log).string());
}

bool has_jobs_override(const SlurmRequest& request) {
  return std::any_of(request.overrides.begin(), request.overrides.end(),
                     [](const auto& override) { return override.first == "study.jobs"; });
}

/// Runs sbatch and returns the job's id.
std::string sbatch(const SlurmRequest& request, const std::string& command) {
  const fs::path errors = slurm_folder(request.folder) / "sbatch.err";
  const ShellResult result = run_shell(fmt::format("{} 2>{}", command, shell_word(errors.string())));
  const std::string reason = fs::exists(errors) ? boost::trim_copy(read_file(errors)) : "";
  std::error_code ignored;
  fs::remove(errors, ignored);
  const std::string id = boost::trim_copy(result.out.substr(0, result.out.find(';')));  // id[;cluster]
  if (result.status != 0 || id.empty())
    throw DataError(fmt::format("Slurm refused the job (exit status {}): {}\n  {}", result.status,
                                reason.empty() ? "no reason given" : reason, command));
  return id;
}

}  // namespace

std::string run_script(const SlurmRequest& request) {
  // Without --cpus-per-task Slurm gives a task one processor, whatever the machine has.
  const std::string jobs = has_jobs_override(request) ? "" : " --study.jobs \"${SLURM_CPUS_PER_TASK:-1}\"";
  return script_head(request, "run", "%A_%a.log") + fmt::format("exec {}{} --study.shard \"$SLURM_ARRAY_TASK_ID/{}\"\n",
                                                                study_command(request, "run"), jobs, request.shards);
}

std::string merge_script(const SlurmRequest& request) {
  return script_head(request, "merge", "%j.log") + fmt::format("exec {}\n", study_command(request, "merge"));
}

std::string array_list(const std::vector<int>& tasks) {
  std::vector<std::string> parts;
  for (std::size_t first = 0; first < tasks.size();) {
    std::size_t last = first;
    while (last + 1 < tasks.size() && tasks[last + 1] == tasks[last] + 1) ++last;
    parts.push_back(first == last ? fmt::format("{}", tasks[first]) : fmt::format("{}-{}", tasks[first], tasks[last]));
    first = last + 1;
  }
  return fmt::format("{}", fmt::join(parts, ","));
}

SlurmSubmission submit_to_slurm(const SlurmRequest& request) {
  if (!in_path("sbatch"))
    throw ConfigurationError(
        "study.stage = submit: no sbatch in PATH, so there is no Slurm here; other schedulers can run "
        "--study.stage run --study.shard i/n for i = 0..n-1, then --study.stage merge");
  fs::create_directories(slurm_folder(request.folder));
  replace_file(run_script_path(request), {run_script(request)});
  replace_file(merge_script_path(request), {merge_script(request)});
  SlurmSubmission submission;
  std::vector<std::string> array{"sbatch", "--parsable", "--array=" + array_list(request.tasks)};
  array.insert(array.end(), request.options.begin(), request.options.end());
  array.push_back(run_script_path(request).string());
  submission.commands.push_back(shell_command(array));
  submission.array_job = sbatch(request, submission.commands.back());
  remember_job(request.folder, {"run", submission.array_job});
  std::vector<std::string> merge{"sbatch", "--parsable", "--dependency=afterany:" + submission.array_job};
  merge.insert(merge.end(), request.options.begin(), request.options.end());
  merge.push_back(merge_script_path(request).string());
  submission.commands.push_back(shell_command(merge));
  submission.merge_job = sbatch(request, submission.commands.back());
  remember_job(request.folder, {"merge", submission.merge_job});
  return submission;
}

}  // namespace modebank::app
