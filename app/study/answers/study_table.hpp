#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank::app {

/// State of a trial. dropped: the configuration is invalid, so the trial is not planned. missing: planned, but neither
/// done nor failed.
enum class TrialStatus { planned, done, failed, dropped, missing };

/// One run of a study.
struct TrialRow {
  std::string key;                  ///< key of the archive trials/<key>.h5; empty if dropped
  std::vector<std::string> varied;  ///< one text per varied key, in the form that `modebank run` reads
  std::int64_t repeat = 0;
  std::uint64_t seed = 0;  ///< its job.seed
  TrialStatus status = TrialStatus::planned;
  std::string message;         ///< reason why the trial failed or was dropped
  std::string evidence;        ///< the archive's finding on modes of motion
  std::vector<double> scores;  ///< one per score name; NaN if the trial has no such score
};

/// The runs of a study in the order of the plan.
struct StudyTable {
  std::vector<std::string> varied_keys;
  std::vector<std::string> score_names;  ///< "modes", then <filter>_<role>_<score> (..._rmse_<state>)
  std::vector<TrialRow> rows;
};

}  // namespace modebank::app

template <>
struct modebank::EnumNames<modebank::app::TrialStatus> {
  static constexpr Names<5> values{"planned", "done", "failed", "dropped", "missing"};
};
