#include "app/study/launch/submit_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>

#include "app/study/launch/slurm.hpp"
#include "app/study/run/trial_order.hpp"

namespace modebank::app {
namespace {

bool is_left(const TrialRow& row) { return row.status == TrialStatus::missing || row.status == TrialStatus::failed; }

/// The number of tasks. It is the configured number, else one task per ten runs, but at most a hundred.
int shard_count(const Config& config, const StudyTable& table) {
  constexpr std::int64_t runs_per_task = 10, most = 100;
  const std::int64_t left = std::count_if(table.rows.begin(), table.rows.end(), is_left);
  const std::int64_t tasks = config.study.slurm_tasks > 0 ? config.study.slurm_tasks
                                                          : std::min(most, (left + runs_per_task - 1) / runs_per_task);
  return static_cast<int>(std::clamp<std::int64_t>(tasks, 1, std::max<std::int64_t>(left, 1)));
}

std::vector<int> unfinished_shards(const TrialGroups& groups, int count, const StudyTable& table) {
  std::vector<int> shards;
  for (int i = 0; i < count; ++i) {
    const TrialGroups share = shard_of(groups, i, count);
    const bool unfinished = std::any_of(share.begin(), share.end(), [&](const auto& group) {
      return std::any_of(group.begin(), group.end(), [&](std::size_t row) { return is_left(table.rows[row]); });
    });
    if (unfinished) shards.push_back(i);
  }
  return shards;
}

std::vector<std::string> words_of_line(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// The request, in which the tasks are still missing.
SlurmRequest request_of(const StudyCall& call) {
  namespace fs = std::filesystem;
  const Config& config = call.config;
  return {fs::read_symlink("/proc/self/exe"),
          fs::absolute(call.config_file),
          fs::absolute(config.study.output).lexically_normal(),
          config.data.root,
          call.overrides,
          1,
          {},
          words_of_line(config.study.slurm_options)};
}

}  // namespace

void check_submission(const StudyCall& call) { check_request(request_of(call)); }

std::string submit_study(const StudyCall& call, const StudyPlan& plan, const StudyTable& table) {
  const Config& config = call.config;
  const int count = shard_count(config, table);
  const std::vector<int> tasks = unfinished_shards(group_trials(config, plan), count, table);
  if (tasks.empty()) return "slurm     nothing to submit: every run is done\n";
  SlurmRequest request = request_of(call);
  request.shards = count;
  request.tasks = tasks;
  const SlurmSubmission submission = submit_to_slurm(request);
  std::string text;
  for (const std::string& command : submission.commands) text += command + "\n";
  return text + fmt::format(
                    "slurm     job {}: {} of {} shards; job {} merges when they have ended. --study.stage status shows "
                    "their states\n",
                    submission.array_job, tasks.size(), count, submission.merge_job);
}

}  // namespace modebank::app
