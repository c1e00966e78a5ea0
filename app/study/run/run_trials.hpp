#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/study/run/study_worker.hpp"
#include "app/study/run/trial_order.hpp"

namespace modebank::app {

/// Result of running a study.
struct RunResult {
  std::size_t computed = 0, present = 0;
  std::vector<std::size_t> failed;    ///< rows
  std::vector<std::string> whole;     ///< keys of archives that this execution checked or wrote
  std::optional<std::string> broken;  ///< reason why the study stopped (TrialOutcome::broken)
  double seconds = 0.0;
};

/// Settings that all trials of an execution share.
struct TrialSettings {
  Config config;      ///< the study's
  std::string typed;  ///< the command line, for the provenance
  std::string version;
};

/// Called for every finished trial. The arguments are the trial's row, its report, the number of finished trials and
/// the number of all trials.
using TrialListener = std::function<void(const TrialRow&, const TrialReport&, std::size_t finished, std::size_t all)>;

/// Runs the trials of these groups in study.jobs processes of this program.
/// - A trial with a complete archive is not run again; a failed trial is.
/// - Each process begins with another group and skips trials that other processes have claimed. At its end it waits for
///   these trials.
/// - A trial fails if its process crashes. A new process then replaces the old one.
RunResult run_trials(const TrialSettings& settings, const StudyPlan& plan, const TrialGroups& groups,
                     const TrialListener& listener);

}  // namespace modebank::app
