#include "app/chain/stage_inputs.hpp"

#include <utility>

#include "filter/learn/learn.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/terms/stated_terms.hpp"
#include "io/import/import.hpp"
#include "mixture/select.hpp"

namespace modebank {
namespace {

BankInputs bank_inputs(const ChainOptions& options, const FitOptions& window) {
  BankInputs inputs{window, options.bank, options.filter.variant == FilterVariant::kf, {}};
  inputs.terms_stated = lists_terms(options.terms);
  inputs.bank.em.seed = options.seed;
  inputs.bank.em.most_modes = most_components(options.mixture.selection);
  inputs.bank.refine = refinement_asked(options.bank, is_linear(window));  // one key for what is the same
  const bool runs_the_filter = inputs.bank.refine == Refine::em || options.bank.modes > 0;
  if (runs_the_filter && !inputs.one_model) inputs.filter = options.filter;
  return inputs;
}

/// Asked where all that is learned by it can have it: no logit, no drift, no look ahead, no R that is given or told
/// from rounding, and an IMM whose noise follows nothing else.
NoiseByInput noise_by_input(const ChainOptions& options, const FitOptions& window) {
  const BankOptions& bank = options.bank;
  const bool can = refinement_asked(bank, is_linear(window)) == Refine::em &&
                   bank.transition != TransitionSource::logit && !bank.measurement_variance &&
                   bank.em.drift == Drift::none && bank.em.look_ahead == 1 &&
                   options.filter.variant == FilterVariant::imm && options.filter.noise == FilterNoise::gaussian;
  return can ? options.noise_by_input : NoiseByInput::none;
}

CompetitorInputs competitor_inputs(const ChainOptions& options, const FitOptions& window) {
  // A single Kalman filter has no use for rivals that are learned as a bank is.
  const bool rivals = options.filter.variant != FilterVariant::kf;
  RefineOptions em = options.bank.em;
  em.seed = options.seed;
  return {window,
          competitor_filter("one_motion", options.filter),
          options.scoring.horizon,
          options.bank.em.transitions,
          options.seed,
          rivals ? options.terms : "none",
          em,
          options.other_lags.linear,
          options.other_lags.drifting,
          noise_by_input(options, window)};
}

/// Learned by refinement, whatever makes the bank.
std::optional<OneMotionInputs> one_motion_inputs(const ChainOptions& options) {
  if (options.filter.variant == FilterVariant::kf) return std::nullopt;
  BankOptions learned;
  learned.measurement_variance = options.bank.measurement_variance;
  learned.em = options.bank.em;
  learned.em.seed = options.seed;
  return OneMotionInputs{learned, competitor_filter("one_motion", options.filter), options.scoring.horizon,
                         options.other_lags.one_motion};
}

}  // namespace

FilterOptions competitor_filter(const std::string& name, const FilterOptions& of_bank) {
  FilterOptions filter;
  filter.variant = name == "baseline" ? FilterVariant::kf : FilterVariant::imm;
  filter.noise = of_bank.noise;
  return filter;
}

ScoringOptions scoring_inputs(const ChainOptions& options) {
  ScoringOptions scoring = options.scoring;
  scoring.seed = options.seed;
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

namespace {

/// With the chain's seed.
FitOptions window_inputs(const ChainOptions& options) {
  FitOptions window = options.window;
  window.seed = options.seed;
  return window;
}

MixtureInputs mixture_inputs(const ChainOptions& options) {
  const std::string& start = options.mixture_start;
  return {window_inputs(options), options.mixture, start, start.empty() ? "" : describe_file(start).sha256,
          options.seed};
}

/// Free runs may not need more measured samples than they start from.
std::optional<StructureInputs> structure_inputs(const ChainOptions& options) {
  if (!options.searched_lags.any()) return std::nullopt;
  StructureInputs inputs{options.searched_lags, {}, options.filter.variant != FilterVariant::kf};
  inputs.window.seed = options.seed;
  inputs.searched.most_samples = options.scoring.free_run.samples;
  const FitOptions& window = options.window;
  if (!options.searched_lags.state) inputs.window.state_lags = window.state_lags;
  if (!options.searched_lags.input) inputs.window.input_lags = window.input_lags;
  if (!options.searched_lags.delay) inputs.window.input_delay = window.input_delay;
  inputs.window.loss = window.loss;
  inputs.window.loss_scale = window.loss_scale;
  inputs.window.intercept = window.intercept;
  inputs.window.max_iterations = window.max_iterations;
  return inputs;
}

}  // namespace

LearningInputs learning_inputs(const ChainOptions& options) {
  const FitOptions window = window_inputs(options);
  return {mixture_inputs(options), competitor_inputs(options, window).filter, bank_inputs(options, window),
          options.filter};
}

ChainInputs chain_inputs(const ChainOptions& options) {
  const FitOptions window = window_inputs(options);
  const ScoringOptions scoring = scoring_inputs(options);
  BankInputs bank = bank_inputs(options, window);
  bank.one_motion = one_motion_inputs(options);
  return {{options.data},
          structure_inputs(options),
          {window},
          mixture_inputs(options),
          competitor_inputs(options, window),
          std::move(bank),
          {window, competitor_filter("one_motion", options.filter), scoring},
          {options.filter, scoring}};
}

}  // namespace modebank
