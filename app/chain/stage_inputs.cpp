#include "app/chain/stage_inputs.hpp"

#include <utility>

namespace modebank {

ScoringOptions scoring_inputs(const ChainOptions& options) {
  ScoringOptions scoring = options.scoring;
  scoring.seed = options.seed;
  FreeRunOptions& free_run = scoring.free_run;
  if (free_run.samples == 0) free_run = {};  // so that equal results have equal keys
  // With transition probabilities that depend on state and input, moments do not follow where each path switches.
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
  return {std::move(learning),
          {options.data},
          {window, competitor_filter("one_motion", options.filter), scoring},
          {options.filter, scoring}};
}

ChainInputs chain_inputs(const ChainOptions& options) { return chain_inputs(options, learning_inputs(options)); }

}  // namespace modebank
