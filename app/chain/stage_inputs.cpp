#include "app/chain/stage_inputs.hpp"

#include <utility>

namespace modebank {

constexpr Index sample_paths = 400;  // of a free run

ScoringOptions scoring_inputs(const ChainOptions& options) {
  ScoringOptions scoring = options.scoring;
  scoring.seed = options.seed;
  FreeRunOptions& free_run = scoring.free_run;
  if (free_run.samples == 0) free_run = {};  // without a free run, its options must not change the key
  // If transition probabilities depend on state and input, each path switches elsewhere, and moments do not show this.
  const bool drawn = options.bank.transition == TransitionSource::logit && free_run.samples > 0;
  free_run.seed = drawn ? options.seed : 0;
  free_run.paths = drawn ? sample_paths : 0;
  return scoring;
}

ChainInputs chain_inputs(const ChainOptions& options, LearningInputs learning) {
  const ScoringOptions scoring = scoring_inputs(options);
  const FitOptions window = learning.windows.window;
  return {std::move(learning), {options.data}, {window, scoring}, {options.filter, scoring}};
}

ChainInputs chain_inputs(const ChainOptions& options) { return chain_inputs(options, learning_inputs(options)); }

}  // namespace modebank
