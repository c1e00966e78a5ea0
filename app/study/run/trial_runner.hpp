#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "app/chain/chain.hpp"
#include "app/chain/stage_store.hpp"
#include "app/config/config.hpp"

namespace modebank::app {

/// Runs trials one after another through one chain, so that trials that share stages should follow one another; other
/// processes share stages through a folder. The archives hold the numbers that `modebank run` writes.
class TrialRunner {
 public:
  /// Stages that took long go to `cache`, up to `limit_mb`; 0: none does.
  explicit TrialRunner(const std::filesystem::path& cache = {}, double limit_mb = 0.0, double worth_a_file_s = 0.2)
      : source_(cache, {worth_a_file_s, Stage::competitor_scores, limit_mb}), chain_(source_, silent_) {}

  /// The trial's archive; `typed` is the command line. Throws what the stages throw.
  const Archive& run(const Config& config, const std::string& typed);

  /// Seconds that the stages computed (rather than shared) by the last run took.
  const std::array<double, stage_count>& seconds() const { return chain_.seconds(); }

 private:
  StageStore source_;
  Listener silent_;  // a thousand trials would each say the same
  Chain chain_;
};

}  // namespace modebank::app
