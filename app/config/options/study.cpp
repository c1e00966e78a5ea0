#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"
#include "app/config/vary_text.hpp"

namespace modebank::app {
namespace {

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
      words("study.stage", "steps to execute: one of them, or all on this machine (plan, run and merge)",
            MODEBANK_FIELD(study.stage))
          .touch("on a cluster: submit, then merge at the end"),
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
