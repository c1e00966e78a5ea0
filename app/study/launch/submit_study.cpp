#include "app/study/launch/submit_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>

#include "app/study/launch/slurm.hpp"

namespace modebank::app {
namespace {

std::vector<std::string> words_of_line(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// The request for one task.
SlurmRequest request_of(const StudyCall& call) {
  namespace fs = std::filesystem;
  const Config& config = call.config;
  return {fs::read_symlink("/proc/self/exe"),
          fs::absolute(call.config_file),
          fs::absolute(config.study.output).lexically_normal(),
          config.data.root,
          call.overrides,
          1,
          words_of_line(config.study.slurm_options)};
}

}  // namespace

void check_submission(const StudyCall& call) { check_request(request_of(call)); }

std::string submit_study(const StudyCall& call, const StudyTable& table) {
  constexpr std::size_t runs_per_task = 10, most_tasks = 100;
  const auto left =
      static_cast<std::size_t>(std::count_if(table.rows.begin(), table.rows.end(), [](const TrialRow& row) {
        return row.status == TrialStatus::missing || row.status == TrialStatus::failed;
      }));
  if (left == 0) return "slurm     nothing to submit: every run is done\n";
  SlurmRequest request = request_of(call);
  request.tasks = std::min(most_tasks, (left + runs_per_task - 1) / runs_per_task);
  const SlurmSubmission submission = submit_to_slurm(request);
  std::string text;
  for (const std::string& command : submission.commands) text += command + "\n";
  return text + fmt::format("slurm     job {}: {} tasks for {} runs; job {} merges when they have ended\n",
                            submission.array_job, request.tasks, left, submission.merge_job);
}

}  // namespace modebank::app
