#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank::app {

/// The steps of `modebank study`. `all` does every step.
enum class StudyStage { all, plan, run, merge, status, submit };

/// Whether a study continues after a failed trial.
enum class OnFailure { record, stop };

/// The [study] section. app/study/space/study_space.hpp parses `vary`, `together` and `when`.
struct StudyConfig {
  std::vector<std::string> vary;      ///< "KEY = v1 | v2" for each varied key
  std::vector<std::string> together;  ///< "KEY, KEY": keys whose values change together
  std::vector<std::string> when;      ///< "KEY if OTHER = v1 | v2": KEY is varied only if OTHER has one of these values
  std::int64_t sample = 0;            ///< number of sampled points; 0: the full grid
  std::int64_t repeats = 1;
  std::string output;  ///< folder of the study; empty: the configuration file's name with .study, in the current folder
  int jobs = 0;        ///< number of processes; 0: one per core
  double timeout_s = 0.0;
  OnFailure on_failure = OnFailure::record;
  StudyStage stage = StudyStage::all;
  std::int64_t shard_index = 0, shard_count = 1;
  std::int64_t slurm_tasks = 0;  ///< number of tasks; 0: derived from the number of runs
  std::string slurm_options;     ///< options for sbatch, separated by spaces
};

}  // namespace modebank::app

template <>
struct modebank::EnumNames<modebank::app::StudyStage> {
  static constexpr Names<6> values{"all", "plan", "run", "merge", "status", "submit"};
};

template <>
struct modebank::EnumNames<modebank::app::OnFailure> {
  static constexpr Names<2> values{"record", "stop"};
};
