#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "app/chain/chain.hpp"
#include "app/chain/stage_store.hpp"
#include "app/config/config.hpp"

namespace modebank::app {

/// Runs trials one after another through one chain. Trials that share stages should be neighbours; processes share
/// stages through a folder. The archives have the same numbers as those of `modebank run`.
class TrialRunner {
 public:
  /// Stages that took long are stored in `cache`, up to `limit_mb`; 0: none.
  explicit TrialRunner(const std::filesystem::path& cache = {}, double limit_mb = 0.0, double worth_a_file_s = 0.2)
      : source_(cache, {worth_a_file_s, Stage::competitor_scores, limit_mb}), chain_(source_, silent_) {}

  /// The trial's archive; `typed` is the command line. Throws what the stages throw.
  const Archive& run(const Config& config, const std::string& typed);

  /// Seconds of each stage that the last run computed; 0 for reused stages.
  const std::array<double, stage_count>& seconds() const { return chain_.seconds(); }

 private:
  StageStore source_;
  Listener silent_;  // a thousand trials would each print the same messages
  Chain chain_;
};

}  // namespace modebank::app
