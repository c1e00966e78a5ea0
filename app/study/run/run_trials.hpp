#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/study/run/study_worker.hpp"
#include "app/study/run/trial_order.hpp"

namespace modebank::app {

/// Result of a share of a study.
struct RunResult {
  std::size_t computed = 0, present = 0;
  std::vector<std::size_t> failed;    ///< rows
  std::vector<std::string> whole;     ///< keys of archives that this execution checked or wrote
  std::optional<std::string> broken;  ///< reason why the study stopped; see TrialOutcome::broken
  double seconds = 0.0;
};

/// Settings that all trials of an execution share.
struct TrialSettings {
  Config config;      ///< the study's
  std::string typed;  ///< the command line, for provenance
  std::string version;
};

/// Called for every finished trial with its row and report, the number finished and the number of all.
using TrialListener = std::function<void(const TrialRow&, const TrialReport&, std::size_t finished, std::size_t all)>;

/// Runs the groups' trials in study.jobs processes of this program. Trials with a complete archive are not run again;
/// failed ones are. Each process begins at another group, skips trials that others have claimed, and waits for those at
/// its end. A trial fails if its process crashes or takes longer than study.timeout_s; a new process then replaces that
/// one.
RunResult run_trials(const TrialSettings& settings, const StudyPlan& plan, const TrialGroups& groups,
                     const TrialListener& listener);

}  // namespace modebank::app
