#pragma once

#include <array>
#include <string>

#include "app/chain/chain.hpp"
#include "app/config/config.hpp"
#include "app/study/run/stage_cache.hpp"

namespace modebank::app {

/// Windows, and mixtures and banks that took long, come from the cache if it has them, and go there if not.
class CachedStages : public StageSource {
 public:
  /// `cache` may be null.
  explicit CachedStages(const StageCache* cache) : cache_(cache) {}
  void provide(Stage stage, const std::string& key, const StagePart& part) override;

 private:
  const StageCache* cache_;
};

/// Runs trials one after another through one chain, so that trials that share stages should follow one another; other
/// processes share through the cache. The archives hold the numbers that `modebank run` writes.
class TrialRunner {
 public:
  /// `cache` may be null.
  explicit TrialRunner(const StageCache* cache) : source_(cache), chain_(source_, silent_) {}

  /// The trial's archive; `typed` is the command line. Throws what the stages throw.
  const Archive& run(const Config& config, const std::string& typed);

  /// Seconds that the stages computed (rather than shared) by the last run took.
  const std::array<double, stage_count>& seconds() const { return chain_.seconds(); }

 private:
  CachedStages source_;
  Listener silent_;  // a thousand trials would each say the same
  Chain chain_;
};

}  // namespace modebank::app
