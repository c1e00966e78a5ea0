#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string.hpp>

#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"
#include "app/config/vary_text.hpp"

namespace modebank::app {
namespace {

Option shard_option() {
  Option result = of_several("study.shard", "i/n with 0 <= i < n", "", "share of the runs that stage run executes");
  result.set = [](Config& config, const std::string& text) {
    const auto slash = text.find('/');
    if (slash == std::string::npos) throw std::invalid_argument("is not of the form i/n");
    Eigen::Index index = 0, count = 0;
    parse_value(text.substr(0, slash), index);
    parse_value(text.substr(slash + 1), count);
    if (index < 0 || index >= count || count > 1'000'000) throw std::invalid_argument("is out of range");
    config.study.shard_index = index;
    config.study.shard_count = count;
  };
  result.get = [](const Config& config) {
    return fmt::format("{}/{}", config.study.shard_index, config.study.shard_count);
  };
  return result;
}

std::vector<Option> space_options() {
  return {
      lines("study.vary", "KEY = v1 | v2 | ...",
            "a key with the values to try. {3..12}, {2..20 step 2}, {0..1 lin 5} and {0.001..1 log 7} expand to "
            "values; with study.sample the ranges {0..1} and {0.001..1 log} are drawn from",
            parse_vary, MODEBANK_FIELD(study.vary))
          .touch("for every study", std::nullopt, basic),
      lines("study.together", "KEY, KEY, ...",
            "varied keys whose values are paired: first with first, second with second", parse_together,
            MODEBANK_FIELD(study.together))
          .touch("when two varied keys belong together (rate and window length)"),
      lines("study.when", "KEY if OTHER = v1 | v2",
            "condition for varying a key: only where another key has one of these values; elsewhere it keeps its "
            "configured value",
            parse_when, MODEBANK_FIELD(study.when))
          .touch("when a varied key has no effect beside some values of another"),
      numeric("study.sample", between(0, 1e6), "",
              "number of points of a Latin hypercube, drawn with job.seed, in place of the full grid; 0: the full grid",
              MODEBANK_FIELD(study.sample))
          .touch("when the full grid has more runs than there is time for"),
      numeric("study.repeats", between(1, 100'000), "",
              "number of runs per point: the first with its own job.seed, the others with seeds derived from it",
              MODEBANK_FIELD(study.repeats))
          .touch("3 or more, when differences between settings may depend on the seed"),
  };
}

std::vector<Option> work_options() {
  return {
      text("study.output", "a folder",
           "folder of the study; empty: this file's name with .study, in the current folder",
           MODEBANK_FIELD(study.output))
          .touch("for another name or place", std::nullopt, basic),
      numeric("study.jobs", between(0, 1024), "", "number of runs at the same time; 0: one per core",
              MODEBANK_FIELD(study.jobs))
          .touch("fewer than the number of cores, when runs need much memory"),
      numeric("study.timeout_s", at_least(0), "s",
              "time limit of a run; a run that takes longer is stopped and counts as failed. 0: no limit",
              MODEBANK_FIELD(study.timeout_s))
          .touch("when some settings take far too long"),
      words("study.on_failure", "what a failed run does to the study: it goes on (the failure is recorded), or stops",
            MODEBANK_FIELD(study.on_failure))
          .touch("stop, while you write a study's configuration"),
      words("study.stage", "steps to execute: one of them, or all on this machine (plan, run and merge)",
            MODEBANK_FIELD(study.stage))
          .touch("on a cluster: submit, then merge at the end"),
      shard_option().touch("to share a study among machines by hand; on a cluster the job script sets it"),
      numeric(
          "study.slurm_tasks", between(0, 1'000'000), "",
          "number of tasks in the job array of submit, each with a share of the runs; 0: one per ten runs, at most 100",
          MODEBANK_FIELD(study.slurm_tasks))
          .touch("when your cluster limits the size of job arrays, or tasks are too short"),
      text("study.slurm_options", "options of sbatch",
           "options for sbatch, separated by spaces, such as --partition=main --time=60 --cpus-per-task=4",
           MODEBANK_FIELD(study.slurm_options))
          .touch("with submit: your cluster's partition, time and memory"),
  };
}

}  // namespace

std::vector<Option> study_options() {
  std::vector<Option> all = space_options();
  for (Option& entry : work_options()) all.push_back(std::move(entry));
  return all;
}

}  // namespace modebank::app
