#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank::app {

/// What became of a trial. dropped: the plan left it out as invalid; missing: planned, but neither done nor failed.
enum class TrialStatus { planned, done, failed, dropped, missing };

/// One run of a study.
struct TrialRow {
  std::string key;                  ///< names trials/<key>.h5; empty when dropped
  std::vector<std::string> varied;  ///< text per varied key, as `modebank run` would be given it
  std::int64_t repeat = 0;
  std::uint64_t seed = 0;  ///< its job.seed
  TrialStatus status = TrialStatus::planned;
  std::string message;         ///< why it failed or was dropped
  std::string evidence;        ///< what its archive answers on modes of motion
  std::vector<double> scores;  ///< one per score name; NaN: it has none
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
