#pragma once

#include <string>

#include "app/study/run_trials.hpp"

namespace modebank::app {

/// What is left to do, how long it will take and how much room it needs.
struct StudyEstimate {
  std::size_t left = 0;  ///< planned runs without an archive
  double seconds = 0.0, bytes = 0.0;
  std::string basis;  ///< what it was made from, in words
};

/// From the log and archives of earlier executions, where the folder has some; else one run, the middle one of the
/// plan, is made now (and kept), and its stages are multiplied by how often the plan needs each.
StudyEstimate estimate_study(const WorkerSettings& settings, const StudyPlan& plan);

}  // namespace modebank::app
