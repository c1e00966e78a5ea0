#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string.hpp>

#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"
#include "app/config/vary_text.hpp"

namespace modebank::app {
namespace {

Option shard_option() {
  Option result = of_several("study.shard", "i/n with 0 <= i < n", "", "run: only this share of the runs");
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
            "values of a key; {3..12}, {2..20 step 2}, {0..1 lin 5} and {0.001..1 log 7} expand; with sample also the "
            "ranges {0..1} and {0.001..1 log}",
            parse_vary, MODEBANK_FIELD(study.vary))
          .touch("for every study: it is what a study varies", std::nullopt, basic),
      lines("study.together", "KEY, KEY, ...", "varied keys whose values go in step: first with first, and so on",
            parse_together, MODEBANK_FIELD(study.together))
          .touch("when two varied keys belong together (rate and window length)"),
      lines("study.when", "KEY if OTHER = v1 | v2",
            "the key is varied only where another one has such a value; elsewhere it stays as configured", parse_when,
            MODEBANK_FIELD(study.when))
          .touch("when a varied key means nothing beside some values of another"),
      numeric("study.sample", between(0, 1e6), "",
              "so many points of a Latin hypercube, drawn with job.seed, instead of the full grid; 0: the grid",
              MODEBANK_FIELD(study.sample))
          .touch("when the full grid has more runs than there is time for"),
      numeric("study.repeats", between(1, 100'000), "",
              "runs of each point: the first with its own job.seed, the others with seeds derived from it",
              MODEBANK_FIELD(study.repeats))
          .touch("3 or more, when differences between settings may be luck of the seed"),
  };
}

std::vector<Option> work_options() {
  return {
      text("study.output", "a folder", "the study's; empty: this file's name with .study, in the current folder",
           MODEBANK_FIELD(study.output))
          .touch("when the study's folder shall have another name or place", std::nullopt, basic),
      numeric("study.jobs", between(0, 1024), "", "runs at a time; 0: one per core", MODEBANK_FIELD(study.jobs))
          .touch("fewer than cores, when runs need much memory"),
      numeric("study.timeout_s", at_least(0), "s", "a run that takes longer is stopped and has failed; 0: no limit",
              MODEBANK_FIELD(study.timeout_s))
          .touch("when some settings take forever and shall count as failed"),
      words("study.on_failure", "a failed run is recorded and the study goes on, or stops",
            MODEBANK_FIELD(study.on_failure))
          .touch("stop, while you try out a study's configuration"),
      words("study.stage", "one step alone; all: plan, run and merge on this machine", MODEBANK_FIELD(study.stage))
          .touch("on a cluster: submit, then merge at the end; on one machine never"),
      shard_option().touch("never on a cluster, whose job script sets it; by hand to share a study among machines"),
      flag("study.flat", "merge: copy the archives into study.h5 instead of linking to them",
           MODEBANK_FIELD(study.flat))
          .touch("when study.h5 must be one file that can be copied alone"),
      numeric("study.slurm_tasks", between(0, 1'000'000), "",
              "submit: tasks of the job array, each a share of the runs; 0: one per ten runs, at most 100",
              MODEBANK_FIELD(study.slurm_tasks))
          .touch("when your cluster limits the size of job arrays, or tasks are too short"),
      text("study.slurm_options", "options of sbatch",
           "submit: separated by spaces, such as --partition=main --time=60 --cpus-per-task=4",
           MODEBANK_FIELD(study.slurm_options))
          .touch("always with submit: your cluster's partition, time and memory"),
  };
}

}  // namespace

std::vector<Option> study_options() {
  std::vector<Option> all = space_options();
  for (Option& entry : work_options()) all.push_back(std::move(entry));
  return all;
}

}  // namespace modebank::app
