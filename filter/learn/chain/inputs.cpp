#include "filter/learn/chain/inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/model/parameter_labels.hpp"
#include "ident/terms/stated_terms.hpp"
#include "mixture/select.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// A free run needs enough measured samples at its start for the model.
std::optional<StructureInputs> structure_inputs(const LearningOptions& options) {
  if (!options.searched_lags.any()) return std::nullopt;
  const bool one_model = options.one_model || options.filter.variant == FilterVariant::kf;
  StructureInputs inputs{options.searched_lags, {}, !one_model};
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

/// Whether to look for noise that follows the input. All later steps must support such noise. The conditions are: an
/// IMM; no logit; R is neither given nor estimated in addition to rounding.
bool noise_may_follow(const LearningOptions& options, const FitOptions& window) {
  const BankOptions& bank = options.bank;
  return refinement_asked(bank, is_linear(window)) == Refine::em && bank.transition != TransitionSource::logit &&
         !bank.measurement_variance && options.filter.variant == FilterVariant::imm;
}

CompetitorInputs competitor_inputs(const LearningOptions& options, const FitOptions& window) {
  // A single Kalman filter is not compared with the competitors that are learned like a bank.
  const bool rivals = options.filter.variant != FilterVariant::kf;
  RefineOptions em = options.bank.em;
  em.seed = options.seed;
  return {window,
          rivals ? options.terms : "none",
          em,
          options.other_lags,
          noise_may_follow(options, window),
          options.bank.measurement_variance,
          options.competitors};
}

BankInputs bank_inputs(const LearningOptions& options, const FitOptions& window) {
  const bool single = options.filter.variant == FilterVariant::kf;
  BankInputs inputs{window, options.bank, options.other_lags, options.scoring.horizon,
                    options.scoring.free_run.samples};
  inputs.one_model = single || options.one_model;
  inputs.one_motion = options.competitors && !single;
  inputs.drifting = options.competitors;
  inputs.terms_stated = lists_terms(options.terms);
  inputs.bank.em.seed = options.seed;
  inputs.bank.em.most_modes = most_components(options.mixture.selection);
  inputs.bank.refine = refinement_asked(options.bank, is_linear(window));  // equal inputs must give equal keys
  if (inputs.bank.refine == Refine::em && !inputs.one_model) inputs.filter = options.filter;
  return inputs;
}

}  // namespace

LearningInputs learning_inputs(const LearningOptions& options) {
  FitOptions window = options.window;
  window.seed = options.seed;
  return {structure_inputs(options),
          window,
          {window, options.mixture, options.seed},
          competitor_inputs(options, window),
          bank_inputs(options, window)};
}

LearningOptions with_structure(const LearningOptions& of, const FoundStructure& found, Index inputs) {
  LearningOptions options = of;
  FitOptions& window = options.window;
  window.state_lags = found.state_lags;
  window.input_lags = found.input_lags;
  window.input_delay = found.delays_of_modes();
  if (has_lags(window)) window.model = "varx";
  for (const StructureScore& s : found.scores) {
    const StageLags lags{s.state_lags, s.input_lags, found.delays_of(s)};
    if (s.linear) options.other_lags.linear = lags;
    if (s.linear && (s.noise_lags > 0 || s.differences)) {
      const Index more = s.differences ? 1 : 0, of_inputs = inputs > 0 ? more : 0;
      options.other_lags.linear = StageLags{s.state_lags + more, s.input_lags + of_inputs, lags.input_delay};
      options.other_lags.armax = armax_of(s, found, inputs, window.intercept);
    }
    if (s.one_motion) options.other_lags.one_motion = lags;
    if (s.drifting) options.other_lags.drifting = lags;
  }
  return options;
}

ArmaxStructure armax_of(const StructureScore& row, const FoundStructure& found, Index inputs, bool intercept) {
  return {{row.differences, row.state_lags, row.input_lags, row.noise_lags, intercept},
          found.delays_of(row).by_input(inputs)};
}

FilterOptions competitor_filter(const std::string& name) {
  return {name == "baseline" ? FilterVariant::kf : FilterVariant::imm};
}

void refuse_constant_states(const Recording& recording) {
  for (Index i = 0; i < recording.state_count(); ++i) {
    double least = INFINITY, largest = -least;
    for (const Trajectory& run : recording.runs) {
      if (run.role != Role::train) continue;
      for (const double value : run.state.row(i)) {
        if (!std::isfinite(value)) continue;
        least = std::min(least, value);
        largest = std::max(largest, value);
      }
    }
    if (least != largest) continue;
    throw DataError(
        fmt::format("the state {0} is constant: {1:g} in every sample of the training runs; nothing "
                    "can be learned about it. Remove {0} from data.state, or train on runs in which it changes",
                    recording.states[static_cast<std::size_t>(i)].name, least));
  }
}

void refuse_unreached_horizons(const Recording& recording, const std::vector<Index>& horizons) {
  const bool held_out = recording.transitions(Role::test) > 0;
  const Trajectory* longest = nullptr;
  for (const Trajectory& run : recording.runs)
    if (run.role == (held_out ? Role::test : Role::train) && (!longest || run.samples() > longest->samples()))
      longest = &run;
  for (const Index horizon : horizons)
    if (longest && horizon > longest->transitions())
      throw DataError(fmt::format(
          "filter.horizon = {} is too long for the {} runs; the longest, {}, has {} samples: choose at "
          "most {}",
          horizon, held_out ? "held-out" : "training", longest->run, longest->samples(), longest->transitions()));
}

std::string unidentifiable_effects(const Recording& recording, const LinearStructure& structure) {
  const std::vector<Index> unidentifiable = unidentifiable_regressors(recording, structure);
  if (unidentifiable.empty()) return {};
  std::vector<std::string> labels = regressor_labels(structure, names_of(recording.states), names_of(recording.inputs));
  labels.emplace_back("the intercept");
  std::vector<std::string> named;
  for (const Index j : unidentifiable)
    named.push_back((j < structure.dimension() ? "the state " : "") + labels[static_cast<std::size_t>(j)]);
  return fmt::format(
      "not identifiable from the training runs: the effect of {}, which {} throughout; the other parameters keep their "
      "standard errors",
      fmt::join(named, ", "), named.size() == 1 ? "is zero" : "are zero or sums of multiples of each other");
}

}  // namespace modebank
