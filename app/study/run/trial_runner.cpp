#include "app/study/run/trial_runner.hpp"

#include "app/chain/provenance.hpp"
#include "app/config/config_file.hpp"

namespace modebank::app {

void CachedStages::provide(Stage stage, const std::string& key, const StagePart& part) {
  constexpr double worth_a_file_s = 0.2;
  const bool shared =
      stage == Stage::structure || stage == Stage::windows || stage == Stage::mixture || stage == Stage::bank;
  if (!cache_ || !shared) return part.compute();
  const auto compute = [&] {
    const Stopwatch watch;
    part.compute();
    return stage == Stage::windows || watch.seconds() > worth_a_file_s;
  };
  cache_->provide(stage, key, part.take, compute, part.copy);
}

const Archive& TrialRunner::run(const Config& config, const std::string& typed) {
  return chain_.run(chain_options(config), Stage::bank_scores,
                    {resolved_text(config), make_provenance(config_hash(config), typed)});
}

}  // namespace modebank::app
