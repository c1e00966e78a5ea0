#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank::app {

/// State of a trial. dropped: invalid, so the plan leaves it out; missing: planned, but neither done nor failed.
enum class TrialStatus { planned, done, failed, dropped, missing };

/// One run of a study.
struct TrialRow {
  std::string key;                  ///< names trials/<key>.h5; empty when dropped
  std::vector<std::string> varied;  ///< one text per varied key, in the form that `modebank run` takes
  std::int64_t repeat = 0;
  std::uint64_t seed = 0;  ///< its job.seed
  TrialStatus status = TrialStatus::planned;
  std::string message;         ///< reason of a failure, or of dropping
  std::string evidence;        ///< its archive's finding on modes of motion
  std::vector<double> scores;  ///< one per score name; NaN: no such score
};

/// A study's runs in plan order.
struct StudyTable {
  std::vector<std::string> varied_keys;
  std::vector<std::string> score_names;  ///< modes, then <filter>_<role>_<score> (..._rmse_<state>)
  std::vector<TrialRow> rows;
};

}  // namespace modebank::app

template <>
struct modebank::EnumNames<modebank::app::TrialStatus> {
  static constexpr Names<5> values{"planned", "done", "failed", "dropped", "missing"};
};
