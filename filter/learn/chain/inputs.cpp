#include "filter/learn/chain/inputs.hpp"

#include <utility>

#include "filter/learn/learn.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/terms/stated_terms.hpp"
#include "mixture/select.hpp"

namespace modebank {
namespace {

std::optional<SingleModel> single_model(const LearningOptions& options) {
  if (!options.other_lags.armax) return {};
  return SingleModel{*options.other_lags.armax, options.bank.measurement_variance};
}

BankInputs bank_inputs(const LearningOptions& options, const FitOptions& window) {
  BankInputs inputs{window, options.bank, options.filter.variant == FilterVariant::kf, {}};
  inputs.single = single_model(options);
  inputs.terms_stated = lists_terms(options.terms);
  inputs.bank.em.seed = options.seed;
  inputs.bank.em.most_modes = most_components(options.mixture.selection);
  inputs.bank.refine = refinement_asked(options.bank, is_linear(window));  // equal inputs must give equal keys
  if (inputs.bank.refine == Refine::em && !inputs.one_model) inputs.filter = options.filter;
  return inputs;
}

/// Whether to look for noise that follows the input. All later steps must support such noise. The conditions are: an
/// IMM; no logit or look-ahead; R is neither given nor estimated in addition to rounding.
NoiseByInput noise_by_input(const LearningOptions& options, const FitOptions& window) {
  const BankOptions& bank = options.bank;
  const bool can = refinement_asked(bank, is_linear(window)) == Refine::em &&
                   bank.transition != TransitionSource::logit && !bank.measurement_variance &&
                   bank.em.look_ahead == 1 && options.filter.variant == FilterVariant::imm;
  return can ? options.noise_by_input : NoiseByInput::none;
}

CompetitorInputs competitor_inputs(const LearningOptions& options, const FitOptions& window) {
  // A single Kalman filter is not compared with the competitors that are learned like a bank.
  const bool rivals = options.filter.variant != FilterVariant::kf;
  RefineOptions em = options.bank.em;
  em.seed = options.seed;
  return {window,
          options.bank.em.transitions,
          options.seed,
          rivals ? options.terms : "none",
          em,
          options.other_lags.linear,
          noise_by_input(options, window),
          single_model(options),
          options.competitors};
}

/// `one_motion` is learned by refinement, whatever the source of the bank.
std::optional<OneMotionInputs> one_motion_inputs(const LearningOptions& options) {
  if (options.filter.variant == FilterVariant::kf) return std::nullopt;
  BankOptions learned;
  learned.measurement_variance = options.bank.measurement_variance;
  learned.em = options.bank.em;
  learned.em.seed = options.seed;
  return OneMotionInputs{learned, options.scoring.horizon, options.other_lags.one_motion};
}

}  // namespace

FilterOptions competitor_filter(const std::string& name) {
  return {name == "baseline" ? FilterVariant::kf : FilterVariant::imm};
}

namespace {

/// The window options with the chain's seed.
FitOptions window_inputs(const LearningOptions& options) {
  FitOptions window = options.window;
  window.seed = options.seed;
  return window;
}

/// A free run needs enough measured samples at its start for the model.
std::optional<StructureInputs> structure_inputs(const LearningOptions& options) {
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
  inputs.window.centre = window.centre;
  inputs.window.max_iterations = window.max_iterations;
  return inputs;
}

}  // namespace

LearningInputs learning_inputs(const LearningOptions& options) {
  const FitOptions window = window_inputs(options);
  BankInputs bank = bank_inputs(options, window);
  if (options.competitors) {
    bank.one_motion = one_motion_inputs(options);
    bank.drifting = DriftingInputs{options.scoring.horizon, options.other_lags.drifting};
  }
  return {structure_inputs(options),
          {window},
          {window, options.mixture, options.seed},
          competitor_inputs(options, window),
          std::move(bank)};
}

}  // namespace modebank
