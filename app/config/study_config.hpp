#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank::app {

/// The steps of `modebank study`. `all` does every step.
enum class StudyStage { all, plan, run, merge, status, submit };

/// The [study] section. app/study/space/study_space.hpp parses `vary` and `together`.
struct StudyConfig {
  std::vector<std::string> vary;      ///< "KEY = v1 | v2" for each varied key
  std::vector<std::string> together;  ///< "KEY, KEY": keys whose values change together
  std::int64_t sample = 0;            ///< number of sampled points; 0: the full grid
  std::int64_t repeats = 1;
  std::string output;  ///< folder of the study; empty: the configuration file's name with .study, in the current folder
  int jobs = 0;        ///< number of processes; 0: one per core
  StudyStage stage = StudyStage::all;
  std::string slurm_options;  ///< options for sbatch, separated by spaces
};

}  // namespace modebank::app

template <>
struct modebank::EnumNames<modebank::app::StudyStage> {
  static constexpr Names<6> values{"all", "plan", "run", "merge", "status", "submit"};
};
