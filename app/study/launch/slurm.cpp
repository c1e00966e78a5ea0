#include "app/study/launch/slurm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <nlohmann/json.hpp>
#include <regex>

#include "app/study/launch/shell.hpp"
#include "ident/base/characters.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/temporary_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;

fs::path slurm_folder(const fs::path& study) { return study / "slurm"; }
fs::path run_script_path(const SlurmRequest& request) { return slurm_folder(request.folder) / "run.sh"; }
fs::path merge_script_path(const SlurmRequest& request) { return slurm_folder(request.folder) / "merge.sh"; }

std::string study_command(const SlurmRequest& request, const std::string& stage) {
  std::vector<std::string> words{request.program.string(), "study", request.config.string()};
  for (const auto& [key, value] : request.overrides)
    if (key != "study.output" && key != "study.stage" && key != "data.root")
      words.insert(words.end(), {"--" + key, value});
  words.insert(words.end(), {"--data.root", request.data_root.string(), "--study.output", request.folder.string(),
                             "--study.stage", stage});
  return shell_command(words);
}

/// The beginning of both scripts. #SBATCH lines contain no paths, because Slurm has its own quotes and patterns there.
/// Logs are appended, so that a task that starts again keeps its earlier log.
std::string script_head() {
  return fmt::format(
      "#!/bin/bash\n"
      "# Written by: modebank study --study.stage submit\n"
      "#SBATCH --requeue\n"
      "#SBATCH --open-mode=append\n"
      "cd {} || exit\n",
      shell_word(fs::current_path().string()));
}

/// Name of a job, such as "run-ice.study". It contains only characters that have no special meaning in patterns, queue
/// listings and shells.
std::string job_name(const SlurmRequest& request, const std::string& role) {
  std::string name = role + "-" + request.folder.filename().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !is_letter(c) && !is_digit(c) && c != '.' && c != '-'; }, '_');
  return name;
}

/// Path of a log in the scripts' folder, for --output of sbatch. This option is a pattern, so each per cent sign in the
/// path is doubled.
std::string log_pattern(const SlurmRequest& request, const std::string& log) {
  return boost::replace_all_copy(slurm_folder(request.folder).string(), "%", "%%") + "/" + log;
}

/// The sbatch command of one script.
std::vector<std::string> sbatch_words(const SlurmRequest& request, const std::string& role, const std::string& log,
                                      const std::string& when, const fs::path& script) {
  std::vector<std::string> words{"sbatch", "--parsable", "--job-name=" + job_name(request, role),
                                 "--output=" + log_pattern(request, log), when};
  words.insert(words.end(), request.options.begin(), request.options.end());
  words.push_back(script.string());
  return words;
}

/// A path for a message, in quotes. Control characters are escaped.
std::string quoted_path(const fs::path& path) {
  return nlohmann::json(path.string()).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

bool has_jobs_override(const SlurmRequest& request) {
  return std::any_of(request.overrides.begin(), request.overrides.end(),
                     [](const auto& override) { return override.first == "study.jobs"; });
}

/// Runs sbatch and returns the job's id.
std::string sbatch(const SlurmRequest& request, const std::string& command) {
  const fs::path errors = temporary_path(slurm_folder(request.folder) / "sbatch.err");
  const ShellResult result = run_shell(fmt::format("{} 2>{}", command, shell_word(errors.string())));
  const std::string reason = fs::exists(errors) ? boost::trim_copy(read_file(errors)) : "";
  std::error_code ignored;
  fs::remove(errors, ignored);
  std::string id;  // the last number: sites print banners before it, or words around it
  static const std::regex number(R"((^|\s)(\d+)(?![^;\s]))");
  for (std::sregex_iterator it(result.out.begin(), result.out.end(), number), end; it != end; ++it) id = (*it)[2];
  if (result.status != 0 || id.empty())
    throw DataError(fmt::format("Slurm refused the job (exit status {}): {}\n  {}", result.status,
                                reason.empty() ? "no number of a job in: " + result.out : reason, command));
  return id;
}

}  // namespace

std::string run_script(const SlurmRequest& request) {
  // Without --cpus-per-task, Slurm gives a task one processor.
  const std::string jobs = has_jobs_override(request) ? "" : " --study.jobs \"${SLURM_CPUS_PER_TASK:-1}\"";
  return script_head() + fmt::format("exec {}{}\n", study_command(request, "run"), jobs);
}

std::string merge_script(const SlurmRequest& request) {
  return script_head() + fmt::format("exec {}\n", study_command(request, "merge"));
}

void check_request(const SlurmRequest& request) {
  if (!in_path("sbatch"))
    throw ConfigurationError(
        "study.stage = submit needs Slurm, but PATH has no sbatch; with another scheduler run --study.stage run "
        "in any number of processes, then --study.stage merge");
  for (const std::string& option : request.options)
    if (option.starts_with("--ar") || option.starts_with("-a") || option.find_first_of("'\"") != std::string::npos)
      throw ConfigurationError(fmt::format(
          "study.slurm_options: {}: modebank sets --array, and cuts options at blanks in quotes, too", option));
  for (const fs::path& path :
       {request.program, request.config, request.folder, request.data_root, fs::current_path()}) {
    const std::string text = path.string();
    if (std::any_of(text.begin(), text.end(), is_control))
      throw ConfigurationError(
          fmt::format("study.stage = submit: the path {} contains a control character, which Slurm does not take; "
                      "rename the folder",
                      quoted_path(path)));
  }
  if (request.folder.string().find('\\') != std::string::npos)
    throw ConfigurationError(
        fmt::format("study.stage = submit: the path {} contains a backslash, which Slurm drops from the names of logs; "
                    "set another study.output",
                    request.folder.string()));
}

SlurmSubmission submit_to_slurm(const SlurmRequest& request) {
  check_request(request);
  make_own_folder(slurm_folder(request.folder));
  replace_file(run_script_path(request), {run_script(request)});
  replace_file(merge_script_path(request), {merge_script(request)});
  SlurmSubmission submission;
  submission.commands.push_back(shell_command(
      sbatch_words(request, "run", "%A_%a.log", fmt::format("--array=1-{}", request.tasks), run_script_path(request))));
  submission.array_job = sbatch(request, submission.commands.back());
  submission.commands.push_back(shell_command(sbatch_words(
      request, "merge", "%j.log", "--dependency=afterany:" + submission.array_job, merge_script_path(request))));
  submission.merge_job = sbatch(request, submission.commands.back());
  return submission;
}

}  // namespace modebank::app
