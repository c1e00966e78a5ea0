#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <fstream>
#include <map>
#include <sstream>

#include "app/study/launch/shell.hpp"
#include "app/study/launch/slurm.hpp"
#include "app/study/launch/slurm_jobs.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

struct TaskState {
  std::string state, reason;
};
using TaskStates = std::map<std::string, TaskState>;  // states by the task's id, "12_3" or "12"

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  return boost::split(fields, line, boost::is_any_of("|"));
}

/// Parses lines of "task|state|reason", which squeue and sacct both print. Of a state such as "CANCELLED by 0", only
/// the first word is used.
TaskStates task_states(const std::string& command, bool& answered) {
  const ShellResult result = run_shell(command + " 2>&1");
  // Of a job that ended long ago, squeue prints an error.
  answered = answered || result.status == 0 || result.out.find("Invalid job id") != std::string::npos;
  TaskStates states;
  if (result.status != 0) return states;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> fields = fields_of(boost::trim_copy(line));
    if (fields.size() < 2 || fields[0].find('[') != std::string::npos) continue;
    states[fields[0]] = {fields[1].substr(0, fields[1].find(' ')), fields.size() > 2 ? fields[2] : ""};
  }
  return states;
}

/// A note if the task needs the user's attention.
std::string note_on(const std::string& task, const TaskState& state) {
  if (state.state == "PENDING" && boost::icontains(state.reason, "held"))
    return fmt::format("task {} is held ({}); release it with scontrol release {}", task, state.reason, task);
  if (boost::icontains(state.reason, "DependencyNeverSatisfied"))
    return fmt::format("job {} waits for a dependency that can no longer be met; cancel it with scancel {}", task,
                       task);
  for (const char* lost : {"FAILED", "CANCELLED", "TIMEOUT", "OUT_OF_MEMORY", "NODE_FAIL", "DEADLINE", "BOOT_FAIL"})
    if (state.state == lost) return fmt::format("task {}: {}; submit again for the remaining runs", task, state.state);
  return "";
}

SlurmJobView view_of(const SlurmJob& job) {
  SlurmJobView view{job.id, job.role, "", false, {}, {}};
  // For jobs that squeue lists, its states are used. sacct, if installed, also lists jobs that have ended.
  bool installed = false;  // sacct is not everywhere
  TaskStates states = task_states(fmt::format("sacct -X -n -P -j {} -o JobID,State", shell_word(job.id)), installed);
  if (!states.empty()) view.source = "sacct";
  const TaskStates queued =
      task_states(fmt::format("squeue -h -r -t all -j {} -o '%i|%T|%r'", shell_word(job.id)), view.answered);
  if (!queued.empty()) view.source = view.source.empty() ? "squeue" : "squeue and sacct";
  for (const auto& [task, state] : queued) states[task] = state;
  std::map<std::string, int> counts;
  for (const auto& [task, state] : states) {
    ++counts[state.state];
    if (const std::string note = note_on(task, state); !note.empty()) view.notes.push_back(note);
  }
  view.states.assign(counts.begin(), counts.end());
  return view;
}

}  // namespace

std::filesystem::path slurm_folder(const std::filesystem::path& study) { return study / "slurm"; }

void remember_job(const std::filesystem::path& study, const SlurmJob& job) {
  const std::filesystem::path file = slurm_folder(study) / "jobs";
  refuse_special_file(file);
  try {
    append_to_file(file, job.role + ' ' + job.id + '\n');
  } catch (const std::exception& error) {
    throw DataError(fmt::format("{}: cannot store the id of Slurm job {}: {}", file.string(), job.id, error.what()));
  }
}

std::vector<SlurmJob> remembered_jobs(const std::filesystem::path& study) {
  refuse_special_file(slurm_folder(study) / "jobs");
  std::ifstream stream(slurm_folder(study) / "jobs");
  std::vector<SlurmJob> jobs;
  for (SlurmJob job; stream >> job.role >> job.id;) jobs.push_back(job);
  return jobs;
}

std::vector<SlurmJobView> slurm_view(const std::filesystem::path& folder) {
  std::vector<SlurmJobView> views;
  for (const SlurmJob& job : remembered_jobs(folder)) views.push_back(view_of(job));
  return views;
}

std::string slurm_text(const std::vector<SlurmJobView>& jobs) {
  constexpr std::size_t notes_shown = 5;
  std::string text;
  for (const SlurmJobView& job : jobs) {
    text += fmt::format("slurm     {} job {}:", job.role, job.job);
    if (job.states.empty()) text += job.answered ? " no longer listed by Slurm" : " Slurm does not answer";
    for (const auto& [state, count] : job.states) text += fmt::format(" {} {}", count, boost::to_lower_copy(state));
    text += job.source.empty() ? "\n" : fmt::format(" ({})\n", job.source);
    for (std::size_t i = 0; i < std::min(job.notes.size(), notes_shown); ++i)
      text += "          " + job.notes[i] + "\n";
    if (job.notes.size() > notes_shown)
      text += fmt::format("          and {} more like these\n", job.notes.size() - notes_shown);
  }
  return text;
}

}  // namespace modebank::app
