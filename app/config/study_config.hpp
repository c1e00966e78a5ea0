#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank::app {

/// What `modebank study` does: everything, or one step of it.
enum class StudyStage { all, plan, run, merge, status, submit };

/// What a failed trial means for the others.
enum class OnFailure { record, stop };

/// The [study] section. The texts of vary, together and when are taken apart by app/study/space/study_space.hpp.
struct StudyConfig {
  std::vector<std::string> vary;      ///< "KEY = v1 | v2", one key each
  std::vector<std::string> together;  ///< "KEY, KEY": varied in step
  std::vector<std::string> when;      ///< "KEY if OTHER = v1 | v2"
  std::int64_t sample = 0;            ///< 0: the full grid
  std::int64_t repeats = 1;
  std::string output;  ///< folder; empty: the configuration file's name with .study, in the current folder
  int jobs = 0;        ///< 0: one per core
  double timeout_s = 0.0;
  OnFailure on_failure = OnFailure::record;
  StudyStage stage = StudyStage::all;
  std::int64_t shard_index = 0, shard_count = 1;
  bool flat = false;
  std::int64_t slurm_tasks = 0;  ///< 0: by the number of runs
  std::string slurm_options;     ///< of sbatch, separated by spaces
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
