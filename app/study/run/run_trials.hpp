#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/study/run/trial_order.hpp"
#include "app/study/run/trial_worker.hpp"

namespace modebank::app {

/// What became of a share of a study.
struct RunResult {
  std::size_t computed = 0, present = 0;
  std::vector<std::size_t> failed;    ///< rows
  std::vector<std::string> whole;     ///< keys whose archives were checked or written by this execution
  std::optional<std::string> broken;  ///< why the study stopped; see TrialOutcome::broken
  double seconds = 0.0;
};

/// Told of every finished trial: the row and its report, and how many of how many are finished.
using TrialListener = std::function<void(const TrialRow&, const TrialReport&, std::size_t finished, std::size_t all)>;

/// Takes the groups' trials with study.jobs processes, each staying with a group as long as it can. Trials that another
/// process holds come last, and are waited for.
RunResult run_trials(const WorkerSettings& settings, const StudyPlan& plan, const TrialGroups& groups,
                     const TrialListener& listener);

/// Number of processes that study.jobs asks for.
std::size_t job_count(const StudyConfig& study);

}  // namespace modebank::app
