#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "app/command_line.hpp"
#include "app/pipeline.hpp"
#include "app/study/stage_cache.hpp"
#include "app/study/stage_inputs.hpp"
#include "io/archive.hpp"

namespace modebank::app {

/// Runs trials one after another. What it holds of the last one is used again where the next one's stage would come out
/// the same, so trials that share should follow one another; windows, and mixtures and banks that took long, are shared
/// with other processes through the cache. The archives hold the numbers that `modebank run` writes.
class TrialRunner {
 public:
  /// `cache` may be null.
  explicit TrialRunner(const StageCache* cache) : cache_(cache) {}

  /// The trial's archive. Throws what the stages throw.
  const Archive& run(const Config& config, const CommandLine& line);

  /// Seconds that the stages computed (rather than shared) by the last run took.
  const std::array<double, trial_stage_count>& seconds() const { return seconds_; }

 private:
  /// Calls `make` unless the stage is still that of the last trial.
  void renew(TrialStage stage, const std::function<void()>& make);
  /// The same through the cache: `compute` fills archive_, `part` copies from it, `take` fills it from a copy.
  void share(TrialStage stage, const std::function<void()>& compute, const std::function<Archive()>& part,
             const std::function<void(Archive&&)>& take);
  void learn(const Config& config);
  void score(const Config& config);

  const StageCache* cache_;
  Archive archive_;
  Provenance imported_;  ///< what import_stage says of the data
  std::map<std::string, FilterScores> scores_;
  std::map<std::string, ResidualTestSet> tests_;
  std::array<std::string, trial_stage_count> wanted_, held_;
  std::array<double, trial_stage_count> seconds_{};
};

}  // namespace modebank::app
