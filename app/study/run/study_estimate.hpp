#pragma once

#include <string>

#include "app/study/run/run_trials.hpp"

namespace modebank::app {

/// What is left to do, how long it will take and how much room it needs.
struct StudyEstimate {
  std::size_t left = 0;  ///< planned runs without an archive
  double seconds = 0.0, bytes = 0.0;
  bool known = true;  ///< false: no run succeeded that it could be made from
  std::string basis;  ///< what it was made from, in words
};

/// What an estimate may be made from where no run was made before.
enum class Sampling { make_some_runs, what_is_there };

/// From the log and archives of the runs made before; where there are none some may be made now, and kept: one in ten,
/// at most eight or one per process, as the keys' hashes fall. The seconds of a stage that runs share count once for
/// each of its different inputs, here and in the plan.
StudyEstimate estimate_study(const WorkerSettings& settings, const StudyPlan& plan, Sampling sampling);

}  // namespace modebank::app
