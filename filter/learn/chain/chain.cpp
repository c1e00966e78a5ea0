#include "filter/learn/chain/chain.hpp"

#include <fmt/format.h>

#include <memory>

#include "filter/judge/finding.hpp"
#include "filter/learn/chain/training_check.hpp"
#include "filter/learn/from_mixture/cluster_windows.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/window_length.hpp"
#include "modebank/base/eigen.hpp"

namespace modebank {
namespace {

/// Executes the stages for one call of the chain.
class Run {
 public:
  Run(const Recording& recording, const LearningHooks& hooks, const Progress& progress, Learning& learned)
      : recording_(recording), hooks_(hooks), progress_(progress), learned_(learned) {}

  void find_lags(const LearningInputs& inputs) {
    if (!inputs.structure) return learned_.structure.reset();
    provide(Stage::structure, inputs,
            [&] { learned_.structure = search_structure(recording_, *inputs.structure, progress_); });
  }

  void identify(const LearningInputs& inputs) {
    provide(Stage::windows, inputs, [&] {
      const FitOptions& window = inputs.windows.window;
      if (const std::string unidentifiable = unidentifiable_effects(recording_, window); !unidentifiable.empty())
        progress_.warning(unidentifiable);
      const Stopwatch watch;
      learned_.windows =
          hooks_.motion ? fit_windows(recording_, window, *hooks_.motion) : fit_windows(recording_, window);
      progress_.progress(fmt::format("windows: {} fitted in {:.2f} s", learned_.windows->count(), watch.seconds()));
    });
  }

  void learn_baseline(const LearningInputs& inputs) {
    const CompetitorInputs& of = inputs.competitors;
    const OneModel linear = one_model(recording_, *learned_.windows, motion_of(inputs.windows.window), of.linear);
    learned_.baseline = learn_single_filter(recording_, linear, of, progress_);
  }

  void cluster(const LearningInputs& inputs) {
    provide(Stage::mixture, inputs, [&] {
      const MixtureInputs& of = inputs.mixture;
      const Stopwatch watch;
      learned_.mixture = cluster_windows(recording_, *learned_.windows, of.window, of.mixture, of.seed);
      const MixtureResult& found = *learned_.mixture;
      const std::string part =
          found.compared > 0 ? ", candidates compared on " + of_all(found.compared, found.clustered) + "," : "";
      progress_.progress(fmt::format("mixture: {} components from {} windows{} in {:.2f} s", found.mixture.components(),
                                     found.clustered, part, watch.seconds()));
    });
  }

  void learn_competitors(const LearningInputs& inputs) {
    learned_.terms_asked = inputs.competitors.terms != "none";
    provide(Stage::competitors, inputs, [&] {
      static_cast<CompetitorsPart&>(learned_) = modebank::learn_competitors(
          recording_, *learned_.windows, motion_of(inputs.windows.window), inputs.competitors, progress_);
    });
  }

  void learn_bank(const LearningInputs& inputs, bool one_model) {
    provide(Stage::bank, inputs, [&] { static_cast<BankPart&>(learned_) = bank_of(inputs.bank, one_model); });
  }

 private:
  const Recording& recording_;
  const LearningHooks& hooks_;
  const Progress& progress_;
  Learning& learned_;
  std::shared_ptr<const MotionModel> named_ = {};  ///< motion model of window.model

  const MotionModel* motion_of(const FitOptions& window) {
    if (!hooks_.motion && !named_) named_ = motion_model(window, recording_.state_count(), recording_.input_count());
    return hooks_.motion ? hooks_.motion : named_.get();
  }

  void provide(Stage stage, const LearningInputs& inputs, const std::function<void()>& compute) {
    if (hooks_.provide)
      hooks_.provide(stage, inputs, compute);
    else
      compute();
  }

  BankPart bank_of(BankInputs asked, bool one_model) {
    const Stopwatch watch;
    if (one_model) {
      asked.one_model = true;
      progress_.progress("bank: equals baseline, because the time steps differ too much");
    }
    if (learned_.noise_only && !learned_.noise_only->noise_factor.empty()) {
      asked.bank.em.noise_by_input = true;
      if (asked.one_motion) asked.one_motion->bank.em.noise_by_input = true;
    }
    const LearnedFrom from{recording_, *learned_.windows, *learned_.mixture, *learned_.baseline,
                           motion_of(asked.window)};
    Refinement refined = learn_modes(from, asked, progress_);
    if (hooks_.refined) hooks_.refined(refined);
    BankPart part;
    if (asked.bank.refine == Refine::em && !asked.one_model) part.unrefined = std::move(refined.start);
    part.measured_fit = refined.measurement.end;
    part.learned_transitions = refined.learned_transitions;
    part.bank = std::move(refined.bank);
    progress_.progress(fmt::format("bank: {} modes, {} removed as unusable, in {:.2f} s", part.bank->mode_count(),
                                   part.bank->screened.size(), watch.seconds()));
    Refinement one_motion;
    if (asked.one_motion) {
      one_motion = learn_one_motion(from, *part.bank, asked, progress_);
      part.one_motion = std::move(one_motion.bank);
    }
    if (asked.drifting) part.drifting = learn_drifting(from, part.one_motion, asked, progress_);
    if (!asked.one_motion) return part;
    learned_.drifting = part.drifting;
    part.left_out = score_left_out(
        recording_, learned_, asked,
        {{"bank", std::move(refined.of_splits)}, {"one_motion", std::move(one_motion.of_splits)}}, progress_);
    return part;
  }
};

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

/// Sets the options that must be found from the data.
LearningOptions found_in(const Recording& recording, LearningOptions options,
                         const std::optional<FoundStructure>& structure) {
  if (structure) options = with_structure(options, *structure, recording.input_count());
  if (options.automatic_windows.length) options.window.length = automatic_length(recording, options.window);
  if (options.automatic_windows.step) options.window.step = automatic_step(recording);
  return options;
}

}  // namespace

void learn_all(const Recording& recording, const LearningOptions& asked, Stage last, bool one_model,
               const LearningHooks& hooks, const Progress& progress, Learning& learned) {
  if (last < Stage::structure) return;
  refuse_constant_states(recording);
  const LearningOptions options = with_intercept(recording, asked);
  Run run(recording, hooks, progress, learned);
  LearningInputs inputs = learning_inputs(options);
  if (inputs.structure && one_model) inputs.structure->with_modes = false;
  run.find_lags(inputs);
  if (last < Stage::windows) return;
  inputs = learning_inputs(found_in(recording, options, learned.structure));
  run.identify(inputs);
  if (last < Stage::bank && learned.structure) run.learn_baseline(inputs);
  if (last >= Stage::mixture) run.cluster(inputs);
  if (last < Stage::bank) return;
  run.learn_competitors(inputs);
  run.learn_bank(inputs, one_model);
}

std::optional<Bank> Learning::bank_of(const std::string& filter) const {
  if (filter == "bank") return bank;
  if (filter == "baseline") return baseline;
  if (filter == "noise_only") return noise_only;
  if (filter == "one_motion") return one_motion;
  if (filter == "nonlinear") return nonlinear;
  if (filter == "drifting") return drifting;
  if (filter == combined_name && bank) return combined_frame(*bank);
  return {};
}

std::vector<LearnedFilter> learned_filters(const Learning& learned, const FilterOptions& options) {
  std::vector<LearnedFilter> all;
  if (learned.bank) all.push_back({"bank", *learned.bank, options});
  for (const char* name : competitor_names)
    if (const std::optional<Bank> bank = learned.bank_of(name)) all.push_back({name, *bank, competitor_filter(name)});
  return all;
}

}  // namespace modebank
