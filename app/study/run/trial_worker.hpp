#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "app/study/run/trial_runner.hpp"
#include "app/study/run/trial_store.hpp"
#include "app/study/space/study_plan.hpp"

namespace modebank::app {

/// How a worker leaves a trial. held: another process has it. broken: the machine's fault, not the trial's (a full
/// disk, data that changed): the study must stop.
enum class TrialOutcome { held, present, computed, failed, broken };

struct TrialReport {
  TrialOutcome outcome = TrialOutcome::held;
  std::string message;  ///< why it failed, or what was wrong with the archive that was there
  double seconds = 0.0;
  std::array<double, stage_count> stage_seconds{};
  /// Of the bank on the held-out runs, else on the training runs; NaN: none.
  double log_score = std::numeric_limits<double>::quiet_NaN();
};

/// What a worker is told once.
struct WorkerSettings {
  Config config;      ///< the study's
  std::string typed;  ///< the command line, for provenance
  TrialStore store;
  std::vector<std::string> varied_keys;
  std::string version;
  std::string execution;                                  ///< a random word of its own
  std::map<std::string, FailureRecord> earlier_failures;  ///< by key; those recorded since are not tried again
};

/// A process's part of a study: takes trials by their rows and leaves archives or records of failure.
class TrialWorker {
 public:
  /// `tell_waiting`: see StageCache.
  explicit TrialWorker(const WorkerSettings& settings, std::function<void(bool)> tell_waiting = {});
  TrialReport take(const TrialRow& row);

 private:
  /// What another execution left of the trial: an archive that is whole, or a failure that is not to be tried again.
  std::optional<TrialReport> settled(const TrialRow& row, std::string& found);
  TrialReport compute(const TrialRow& row);
  void write(const TrialRow& row, const Config& config, const Archive& archive, TrialReport& report);

  const WorkerSettings& settings_;
  std::set<std::string> held_;  ///< keys that another process was at
  FileLocks locks_;
  StageCache cache_;
  TrialRunner runner_;
};

}  // namespace modebank::app
