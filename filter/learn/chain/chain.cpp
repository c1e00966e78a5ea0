#include "filter/learn/chain/chain.hpp"

#include <utility>

#include "filter/judge/finding.hpp"
#include "filter/learn/chain/stages.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/window_length.hpp"
#include "modebank/base/eigen.hpp"

namespace modebank {
namespace {

/// Means of the training runs: of each state, then of each input. Missing values do not count.
std::vector<double> training_means(const Recording& recording) {
  const Index n = recording.state_count(), m = recording.input_count();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n + m), count = sum;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    Eigen::MatrixXd values(n + m, run.samples());
    values << run.state, run.input;
    sum += values.array().isFinite().select(values, 0.0).rowwise().sum();
    count += values.array().isFinite().cast<double>().matrix().rowwise().sum();
  }
  return to_vector(sum.cwiseQuotient(count.cwiseMax(1.0)));
}

/// Decides on the constant of linear models. With a constant, all sums are taken about the means of the training runs:
/// priors, distances between windows and the drift of coefficients then do not depend on where zero lies. Before lags
/// are known, the structure has a few more than most plants.
LearningOptions with_intercept(const Recording& recording, LearningOptions options) {
  const bool automatic = options.automatic_windows.intercept;
  if (!is_linear(options.window) || !(automatic || options.window.intercept)) return options;
  options.window.centre = training_means(recording);
  if (!automatic) return options;
  constexpr Index lags = 4, input_lags = 8;
  LinearStructure structure = linear_structure(recording.state_count(), recording.input_count(), options.window);
  if (options.searched_lags.state) structure.state_lags = lags;
  if (options.searched_lags.input) structure.input_lags = input_lags;
  options.window.intercept = needs_constant(recording, structure);
  if (!options.window.intercept) options.window.centre.clear();
  return options;
}

/// The inputs of the stages after the search for a structure, which decides lags, length and step of windows.
LearningInputs inputs_with(const std::optional<FoundStructure>& structure, const Recording& recording,
                           LearningOptions options) {
  if (structure) options = with_structure(options, *structure, recording.input_count());
  if (options.automatic_windows.length) options.window.length = automatic_length(recording, options.window);
  if (options.automatic_windows.step) options.window.step = automatic_step(recording);
  return learning_inputs(options);
}

/// The decisions of the last stage of learn_all, in their order.
void learn_banks(const StageData& data, const BankInputs& inputs, const LearningHooks& hooks, Learning& learned) {
  static_cast<BankPart&>(learned) = {};
  // Modes, their number, transitions: Hamilton's log score of left-out runs. R: that of the filter.
  Refinement refined = learn_modes(data, learned, inputs);
  hooks.refined(refined);
  if (inputs.bank.refine == Refine::em && !inputs.one_model) learned.unrefined = std::move(refined.start);
  learned.measured_fit = refined.measurement.end;
  learned.learned_transitions = refined.learned_transitions;
  learned.bank = std::move(refined.bank);
  // One motion with switching noise: like the bank, and also from the bank's noises.
  Refinement one_motion;
  if (inputs.one_motion) {
    one_motion = learn_one_motion(data, learned, inputs);
    learned.one_motion = std::move(one_motion.bank);
  }
  // How fast coefficients drift, with which noise levels: causal log score of the training runs, one step ahead.
  if (inputs.drifting) learned.drifting = learn_drifting(data, learned, inputs);
  // The first weights of the combination: scores of left-out runs at the asked horizons.
  if (inputs.one_motion)
    learned.left_out = score_left_out(data, learned, inputs, refined.of_splits, one_motion.of_splits);
}

}  // namespace

void learn_all(const Recording& recording, const LearningOptions& asked, Stage last, const LearningHooks& hooks,
               Learning& learned) {
  if (last < Stage::structure) return;
  refuse_constant_states(recording);
  LearningInputs inputs;
  const auto cached = [&](Stage stage, const std::function<void()>& decide) { hooks.provide(stage, inputs, decide); };

  // Constant: likelihood of least squares. Linear stage with R, structures of bank and one motion: log score of
  // left-out runs, one step ahead. Structure of drifting: causal log score of the training runs.
  const LearningOptions options = with_intercept(recording, asked);
  inputs = learning_inputs(options);
  if (!inputs.structure)
    learned.structure.reset();
  else
    cached(Stage::structure, [&] { learned.structure = search_structure(recording, *inputs.structure, hooks.tell); });
  if (last < Stage::windows) return;

  // Windows, whose length and step follow from the structure: robust least squares.
  inputs = inputs_with(learned.structure, recording, options);
  const auto named =
      hooks.motion ? nullptr : motion_model(inputs.windows, recording.state_count(), recording.input_count());
  const std::optional<Recording> part = learning_part(recording, inputs.competitors.em.transitions, asked.seed);
  const StageData data{recording, part ? *part : recording, hooks.motion ? hooks.motion : named.get(), hooks.tell};
  cached(Stage::windows, [&] { learned.windows = identify_windows(data, inputs.windows, hooks.motion); });
  if (last < Stage::bank && learned.structure)
    learned.baseline = learn_single_filter(data, *learned.windows, inputs.competitors);
  if (last < Stage::mixture) return;

  // Number of components of the windows: BIC.
  cached(Stage::mixture, [&] { learned.mixture = cluster(data, *learned.windows, inputs.mixture); });
  if (last < Stage::bank) return;

  // Noise of baseline and noise_only: likelihood. Terms of nonlinear: log score of left-out rows.
  learned.terms_asked = inputs.competitors.terms != "none";
  cached(Stage::competitors, [&] {
    static_cast<CompetitorsPart&>(learned) = learn_competitors(data, *learned.windows, inputs.competitors);
  });
  cached(Stage::bank, [&] { learn_banks(data, inputs.bank, hooks, learned); });
}

std::optional<Bank> Learning::bank_of(const std::string& filter) const {
  if (filter == "bank") return bank;
  if (filter == "baseline") return baseline;
  if (filter == "noise_only") return noise_only;
  if (filter == "one_motion") return one_motion;
  if (filter == "nonlinear") return nonlinear;
  if (filter == "drifting") return drifting;
  return filter == combined_name && bank ? std::optional(combined_frame(*bank)) : std::nullopt;
}

std::vector<LearnedFilter> learned_filters(const Learning& learned, const FilterOptions& options) {
  std::vector<LearnedFilter> all;
  if (learned.bank) all.push_back({"bank", *learned.bank, options});
  for (const char* name : competitor_names)
    if (const std::optional<Bank> bank = learned.bank_of(name)) all.push_back({name, *bank, competitor_filter(name)});
  return all;
}

}  // namespace modebank
