#include "app/chain/stage_inputs.hpp"

#include <utility>

namespace modebank {

ScoringOptions scoring_inputs(const ChainOptions& options) {
  ScoringOptions scoring = options.scoring;
  scoring.seed = options.seed;
  FreeRunOptions& free_run = scoring.free_run;
  if (free_run.samples == 0) free_run = {};  // without a free run, its options must not change the key
  // If transition probabilities depend on state and input, each path switches elsewhere, and moments do not show this.
  if (options.bank.transition == TransitionSource::logit && free_run.samples > 0)
    free_run.method = FreeRunMethod::paths;
  const bool drawn = free_run.method == FreeRunMethod::paths;
  free_run.seed = drawn ? options.seed : 0;
  if (!drawn) free_run.paths = 0;
  return scoring;
}

ChainInputs chain_inputs(const ChainOptions& options, LearningInputs learning) {
  const ScoringOptions scoring = scoring_inputs(options);
  const FitOptions window = learning.windows.window;
  return {std::move(learning), {options.data}, {window, scoring}, {options.filter, scoring}};
}

ChainInputs chain_inputs(const ChainOptions& options) { return chain_inputs(options, learning_inputs(options)); }

}  // namespace modebank
