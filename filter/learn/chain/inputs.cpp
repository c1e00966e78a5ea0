#include "filter/learn/chain/inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

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
  const SearchedLags& searched = options.searched_lags;
  if (!searched.any()) return std::nullopt;
  const FitOptions& given = options.window;
  StructureInputs inputs{searched, {}, !options.one_model && options.filter.variant != FilterVariant::kf};
  inputs.searched.most_samples = options.scoring.free_run.samples;
  FitOptions& window = inputs.window;
  if (!searched.state) window.state_lags = given.state_lags;
  if (!searched.input) window.input_lags = given.input_lags;
  if (!searched.delay) window.input_delay = given.input_delay;
  window.loss = given.loss;
  window.loss_scale = given.loss_scale;
  window.intercept = given.intercept;
  window.centre = given.centre;
  window.max_iterations = given.max_iterations;
  window.seed = options.seed;
  return inputs;
}

}  // namespace

LearningInputs learning_inputs(const LearningOptions& options) {
  const bool single = options.filter.variant == FilterVariant::kf;  // is not compared with what is learned like a bank
  LearningInputs inputs{structure_inputs(options), options.window, {}, {}, {}};
  FitOptions& window = inputs.windows;
  window.seed = options.seed;
  inputs.mixture = {window, options.mixture, options.seed};

  BankInputs& bank = inputs.bank;
  bank = {window, options.bank, options.other_lags, options.scoring.horizon, options.scoring.free_run.samples};
  bank.bank.refine = refinement_asked(options.bank, is_linear(window));  // equal inputs must give equal keys
  bank.bank.em.seed = options.seed;
  bank.one_model = single || options.one_model;
  bank.one_motion = options.competitors && !single;
  bank.drifting = options.competitors;
  bank.terms_stated = lists_terms(options.terms);
  if (bank.bank.refine == Refine::em && !bank.one_model) bank.filter = options.filter;

  CompetitorInputs& competitors = inputs.competitors;
  competitors = {window, single ? "none" : options.terms, bank.bank.em, options.other_lags};
  competitors.measurement_variance = options.bank.measurement_variance;
  competitors.all = options.competitors;
  bank.bank.em.most_modes = most_components(options.mixture.selection);
  return inputs;
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
    if (s.one_motion) options.other_lags.one_motion = lags;
    if (s.drifting) options.other_lags.drifting = lags;
    if (!s.linear) continue;
    const Index more = s.differences ? 1 : 0;
    options.other_lags.linear = {s.state_lags + more, s.input_lags + (inputs > 0 ? more : 0), lags.input_delay};
    if (s.noise_lags > 0 || s.differences) options.other_lags.armax = armax_of(s, found, inputs, window.intercept);
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
    for (const Trajectory& run : recording.runs)
      for (const double value : run.state.row(i))
        if (run.role == Role::train && std::isfinite(value)) {
          least = std::min(least, value);
          largest = std::max(largest, value);
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
          "filter.horizon = {} is too long for the {} runs; the longest, {}, has {} samples: choose at most {}",
          horizon, held_out ? "held-out" : "training", longest->run, longest->samples(), longest->transitions()));
}

std::string unidentifiable_effects(const Recording& recording, const LinearStructure& structure) {
  std::vector<std::string> labels = regressor_labels(structure, names_of(recording.states), names_of(recording.inputs));
  labels.emplace_back("the intercept");
  std::vector<std::string> named;
  for (const Index j : unidentifiable_regressors(recording, structure))
    named.push_back((j < structure.dimension() ? "the state " : "") + labels[static_cast<std::size_t>(j)]);
  if (named.empty()) return {};
  return fmt::format(
      "not identifiable from the training runs: the effect of {}, which {} throughout; the other parameters keep their "
      "standard errors",
      fmt::join(named, ", "), named.size() == 1 ? "is zero" : "are zero or sums of multiples of each other");
}

}  // namespace modebank
