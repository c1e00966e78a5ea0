#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/study/run/study_worker.hpp"
#include "app/study/run/trial_order.hpp"

namespace modebank::app {

/// What became of a share of a study.
struct RunResult {
  std::size_t computed = 0, present = 0;
  std::vector<std::size_t> failed;    ///< rows
  std::vector<std::string> whole;     ///< keys whose archives were checked or written by this execution
  std::optional<std::string> broken;  ///< why the study stopped; see TrialOutcome::broken
  double seconds = 0.0;
};

/// Settings of all trials of an execution.
struct TrialSettings {
  Config config;      ///< the study's
  std::string typed;  ///< the command line, for provenance
  std::string version;
};

/// Told of every finished trial: the row and its report, and how many of how many are finished.
using TrialListener = std::function<void(const TrialRow&, const TrialReport&, std::size_t finished, std::size_t all)>;

/// Runs the groups' trials in study.jobs processes of this program. Trials whose archives are there and whole are not
/// run again; so are those that failed. Each process begins at another group and passes over trials that
/// others have claimed; it waits for those at its end. A trial whose process crashes or takes longer than
/// study.timeout_s has failed, and another process takes that one's place.
RunResult run_trials(const TrialSettings& settings, const StudyPlan& plan, const TrialGroups& groups,
                     const TrialListener& listener);

}  // namespace modebank::app
