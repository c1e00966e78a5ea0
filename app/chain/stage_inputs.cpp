#include "app/chain/stage_inputs.hpp"

#include "filter/learn/learn.hpp"
#include "ident/fit/fit_windows.hpp"
#include "io/import/import.hpp"
#include "mixture/select.hpp"

namespace modebank {
namespace {

BankInputs bank_inputs(const ChainOptions& options, const FitOptions& window) {
  BankInputs inputs{window, options.bank, options.filter.variant == FilterVariant::kf, {}};
  inputs.bank.em.seed = options.seed;
  inputs.bank.em.most_modes = most_components(options.mixture.selection);
  inputs.bank.refine = refinement_asked(options.bank, is_linear(window));  // one key for what is the same
  const bool runs_the_filter = inputs.bank.refine == Refine::em || options.bank.modes > 0;
  if (runs_the_filter && !inputs.one_model) inputs.filter = options.filter;
  return inputs;
}

/// one_motion is learned by refinement, whatever makes the bank; a single Kalman filter has no use for it.
CompetitorInputs competitor_inputs(const ChainOptions& options, const FitOptions& window) {
  CompetitorInputs inputs{window, {}, competitor_filter("one_motion", options.filter), options.scoring.horizon};
  if (options.filter.variant == FilterVariant::kf) return inputs;
  BankOptions learned;
  learned.measurement_variance = options.bank.measurement_variance;
  learned.em = options.bank.em;
  learned.em.seed = options.seed;
  learned.em.drift = {};  // what learns within a run is the bank or the competitor `drifting`
  inputs.one_motion = learned;
  return inputs;
}

}  // namespace

FilterOptions competitor_filter(const std::string& name, const FilterOptions& of_bank) {
  FilterOptions filter;
  filter.variant = name == "baseline" ? FilterVariant::kf : FilterVariant::imm;
  filter.time_steps = of_bank.time_steps;
  filter.noise = of_bank.noise;
  return filter;
}

ScoringOptions scoring_inputs(const ChainOptions& options) {
  ScoringOptions scoring = options.scoring;
  FreeRunOptions& free_run = scoring.free_run;
  if (free_run.samples == 0) free_run = {};  // one key for what is the same
  // Where state and input move the switches, moments do not know where each path switches.
  if (options.bank.transition == TransitionSource::logit && free_run.samples > 0)
    free_run.method = FreeRunMethod::paths;
  const bool drawn = free_run.method == FreeRunMethod::paths;
  free_run.seed = drawn ? options.seed : 0;
  if (!drawn) free_run.paths = 0;
  return scoring;
}

ChainInputs chain_inputs(const ChainOptions& options) {
  FitOptions window = options.window;
  window.seed = options.seed;
  const std::string& start = options.mixture_start;
  const ScoringOptions scoring = scoring_inputs(options);
  return {{options.data},
          {window},
          {options.mixture, start, start.empty() ? "" : describe_file(start).sha256, options.seed},
          competitor_inputs(options, window),
          bank_inputs(options, window),
          {window, competitor_filter("one_motion", options.filter), scoring},
          {options.filter, scoring}};
}

}  // namespace modebank
