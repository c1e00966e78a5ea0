#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "app/chain/chain.hpp"
#include "app/chain/stage_store.hpp"
#include "app/config/config.hpp"

namespace modebank::app {

/// Runs trials one after another through one chain. Consecutive trials should share stages. Different processes share
/// stages through a folder. The archives have the same numbers as archives of `modebank run`.
class TrialRunner {
 public:
  /// Stages that took long are stored in the folder `cache`, up to `limit_mb`. 0: nothing is stored.
  explicit TrialRunner(const std::filesystem::path& cache = {}, double limit_mb = 0.0, double worth_a_file_s = 0.2)
      : source_(cache, {worth_a_file_s, Stage::competitor_scores, limit_mb}), chain_(source_, silent_) {}

  /// Runs a trial and returns its archive. `typed`: the command line. Throws the exceptions of the stages.
  const Archive& run(const Config& config, const std::string& typed);

  /// Seconds of each stage in the last run; 0 if the stage was reused.
  const std::array<double, stage_count>& seconds() const { return chain_.seconds(); }

 private:
  StageStore source_;
  Listener silent_;  // prints nothing: each of a thousand trials would print the same messages
  Chain chain_;
};

}  // namespace modebank::app
