#include "filter/learn/chain/stages.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/linearise.hpp"
#include "ident/terms/find_terms.hpp"
#include "ident/terms/stated_terms.hpp"
#include "ident/terms/term_rows.hpp"

namespace modebank {
namespace {

template <class... Values>
void progress(const Tell& tell, fmt::format_string<Values...> text, Values&&... values) {
  tell(Level::progress, fmt::format(text, std::forward<Values>(values)...));
}

}  // namespace

std::string of_all(Index part, Index all) {
  const auto grouped = [](Index count) {
    std::string digits = std::to_string(count);
    for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
      digits.insert(static_cast<std::size_t>(at), ",");
    return digits;
  };
  return grouped(part) + " of " + grouped(all);
}

std::string learned_words(Index learned, Index all) { return "from " + of_all(learned, all) + " training transitions"; }

WindowFits identify_windows(const StageData& data, const FitOptions& window, const MotionModel* own) {
  const Recording& recording = data.recording;
  const LinearStructure structure = linear_structure(recording.state_count(), recording.input_count(), window);
  if (is_linear(window))
    if (const std::string unidentifiable = unidentifiable_effects(recording, structure); !unidentifiable.empty())
      data.tell(Level::warning, unidentifiable);
  const Stopwatch watch;
  WindowFits windows = own ? fit_windows(recording, window, *own) : fit_windows(recording, window);
  progress(data.tell, "windows: {} fitted in {:.2f} s", windows.count(), watch.seconds());
  return windows;
}

MixtureResult cluster(const StageData& data, const WindowFits& windows, const MixtureInputs& inputs) {
  const Stopwatch watch;
  MixtureResult found = cluster_windows(data.recording, windows, inputs.window, inputs.mixture, inputs.seed);
  progress(data.tell, "mixture: {} components from {} windows{} in {:.2f} s", found.mixture.components(),
           found.clustered,
           found.compared > 0 ? ", candidates compared on " + of_all(found.compared, found.clustered) + "," : "",
           watch.seconds());
  return found;
}

namespace {

struct OneModel {
  std::string model;  ///< name of the windows' model, if that model has these lags
  LinearStructure structure;
  GlobalModel global;
};

/// Fits one model with these lags. If no lags are given, uses those of the windows.
OneModel one_model(const Recording& recording, const WindowFits& windows, const MotionModel* motion,
                   const std::optional<StageLags>& lags, bool constant = false) {
  LinearStructure structure = windows.structure;
  structure.intercept = structure.intercept || constant;
  if (lags) {
    structure.state_lags = lags->state_lags;
    structure.input_lags = lags->input_lags;
    structure.input_delay = lags->input_delay;
  }
  if (structure == windows.structure) return {windows.model, structure, linear_global(recording, windows, motion)};
  return {structure.lagged() ? "varx" : "linear", structure, fit_global(recording, structure)};
}

Bank single_filter(const Recording& recording, const OneModel& of, const CompetitorInputs& inputs, const Tell& tell) {
  if (inputs.lags.armax)
    if (std::optional<Bank> bank = learn_armax(recording, *inputs.lags.armax, inputs.measurement_variance))
      return *std::move(bank);
  Baseline baseline = learn_baseline(recording, of.global, of.structure);
  baseline.bank.model = of.model;
  if (of.structure.inputs > 0)
    baseline.bank.modes.front().response =
        step_response(of.structure, of.global.theta, of.global.covariance,
                      of.structure.input_delay.by_input(of.structure.inputs), baseline.bank.dt_s);
  if (baseline.at_bound) tell(Level::progress, "baseline: R is at its lower bound: the data show no measurement noise");
  if (!baseline.converged)
    tell(Level::warning, "baseline: the search for its noise did not reach a maximum of the likelihood");
  return std::move(baseline.bank);
}

/// The terms given in the configuration, even if they do not gain.
FoundTerms take_stated(const Recording& recording, const LinearStructure& structure, const std::string& terms) {
  constexpr Index enough_rows = 200000;
  std::vector<std::string> names = state_names(recording, structure);
  for (const std::string& input : input_names(recording, structure)) names.push_back(input);
  const TermRows rows = gather_term_rows(recording, structure, enough_rows);
  require_transitions(rows.count() > 0);
  return {structure, stated_terms(read_terms(terms), names, rows.X)};
}

std::optional<Bank> nonlinear(const Recording& recording, LinearStructure structure, const CompetitorInputs& inputs,
                              const Tell& tell) {
  if (inputs.terms == "none") return {};
  structure.centre.clear();  // terms are functions of the values themselves
  const Stopwatch watch;
  const FoundTerms found = lists_terms(inputs.terms) ? take_stated(recording, structure, inputs.terms)
                                                     : find_terms(recording, structure, inputs.window);
  const auto lags_of = [](const LinearStructure& s) {
    return fmt::format("({}, {}, {})", s.state_lags, s.input_lags, fmt::join(s.input_delay.listed(), " "));
  };
  for (const TriedTerms& tried : found.tried)
    tell(Level::detail, fmt::format("nonlinear: {} terms with lags {}: {:.4f} nats/sample on left-out rows",
                                    tried.terms, lags_of(tried.structure), tried.log_score));
  std::string gain = found.terms.empty() ? "no terms gain" : fmt::format("{} terms as configured", found.terms.count());
  if (found.terms_asked > 0)
    gain = fmt::format("{} terms gain {:.4f} +- {:.4f} nats/sample on halves that did not choose them",
                       found.terms_asked, found.gain, found.gain_standard_error);
  if (found.terms.empty()) {
    progress(tell, "nonlinear: {}: not taken, in {:.2f} s", gain, watch.seconds());
    return {};
  }
  Bank bank = learn_nonlinear(recording, found.structure, found.terms, inputs.em);
  progress(tell, "nonlinear: {}: taken with lags {}, {} noise levels, in {:.2f} s", gain, lags_of(found.structure),
           bank.mode_count(), watch.seconds());
  return bank;
}

}  // namespace

Bank learn_single_filter(const StageData& data, const WindowFits& windows, const CompetitorInputs& inputs) {
  const OneModel linear = one_model(data.recording, windows, data.motion, inputs.lags.linear);
  return single_filter(data.recording, linear, inputs, data.tell);
}

CompetitorsPart learn_competitors(const StageData& data, const WindowFits& windows, const CompetitorInputs& inputs) {
  const Recording& recording = data.part;
  if (const Index part = recording.transitions(Role::train), all = data.recording.transitions(Role::train); part < all)
    data.tell(Level::progress, "competitors: learned " + learned_words(part, all));
  const OneModel linear = one_model(recording, windows, data.motion, inputs.lags.linear);
  CompetitorsPart learned;
  learned.baseline = single_filter(recording, linear, inputs, data.tell);
  if (!inputs.all) return learned;
  learned.noise_only = noise_only_beside(*learned.baseline, inputs.lags.armax.has_value(), recording, linear.structure);
  learned.nonlinear = nonlinear(recording, linear.structure, inputs, data.tell);
  return learned;
}

namespace {

void tell_refinement(const Refinement& refined, const Tell& tell) {
  for (const RefineCandidate& c : refined.candidates)
    tell(Level::detail, fmt::format("refine: {:<12} {:>3} modes: {:.4f} nats/sample on left-out runs, {:.4f} +- {:.4f} "
                                    "below the best, after {} iterations{}",
                                    c.start, c.modes, c.score, c.loss, c.loss_standard_error, c.iterations,
                                    c.selected ? " (chosen)" : ""));
  const MeasurementStage& R = refined.measurement;
  if (!std::isnan(R.score_before))
    progress(tell, "refine: {} iterations with measurement noise: {:.4f} -> {:.4f} nats/sample on left-out runs",
             R.iterations, R.score_before, R.score);
  if (const SwitchingStage& s = refined.switching; !std::isnan(s.gain))
    progress(tell, "refine: switching by state and input gains {:.4f} +- {:.4f} nats/sample on left-out runs{}", s.gain,
             s.gain_standard_error, s.width > 0.0 ? fmt::format(" (accepted, width {})", s.width) : ": not taken");
}

}  // namespace

Refinement learn_modes(const StageData& data, const Learning& learned, const BankInputs& inputs) {
  const Stopwatch watch;
  Refinement refined{*learned.baseline};
  if (!inputs.one_model)
    refined = learn_as_asked(data.recording, *learned.windows, *learned.mixture, inputs.bank, learned.baseline->R,
                             inputs.filter, data.motion);
  if (inputs.one_model && inputs.one_motion)
    data.tell(Level::progress, "bank: equals baseline, because the time steps differ too much");
  if (!inputs.one_model && inputs.bank.refine == Refine::none)
    progress(data.tell, "bank: modes of model {} come from the mixture, without refinement", learned.windows->model);
  tell_refinement(refined, data.tell);
  if (const Index learned_from = refined.learned_transitions; learned_from > 0)
    data.tell(Level::progress,
              "refine: learned " + learned_words(learned_from, data.recording.transitions(Role::train)));
  progress(data.tell, "bank: {} modes, {} removed as unusable, in {:.2f} s", refined.bank.mode_count(),
           refined.bank.screened.size(), watch.seconds());
  return refined;
}

Refinement learn_one_motion(const StageData& data, const Learning& learned, const BankInputs& inputs) {
  constexpr Index fewest_levels = 8;  // smallest number of noise levels (method: section 6)
  const Stopwatch watch;
  const Recording& recording = data.part;
  const WindowFits& windows = *learned.windows;
  const OneModel one = one_model(recording, windows, data.motion, inputs.lags.one_motion);
  WindowFits frame;
  frame.structure = one.structure;
  frame.global = one.global;
  if (one.structure == windows.structure) {
    frame.length = windows.length;
    frame.step = windows.step;
    if (windows.model_parameters.empty()) frame.prior_sd = windows.prior_sd;  // else of other parameters
  }
  Refinement refined = learn_one_motion(recording, frame, *learned.bank, learned.baseline->R,
                                        std::max(fewest_levels, learned.mixture->mixture.components()), inputs.bank);
  const Index horizon = *std::ranges::max_element(inputs.horizon);
  if (inputs.simulate > 0 && horizon > 1 && fit_horizon(recording, inputs.bank.em, horizon, inputs.simulate, refined))
    progress(data.tell, "one_motion: errors up to {} samples ahead fit free runs better", horizon);
  progress(data.tell, "one_motion: {} noise levels in {:.2f} s", refined.bank.mode_count(), watch.seconds());
  return refined;
}

Bank learn_drifting(const StageData& data, const Learning& learned, const BankInputs& inputs) {
  const Stopwatch watch;
  const Recording& recording = data.part;
  const bool level_wanders = inputs.lags.armax && inputs.lags.armax->order.differences;
  const OneModel of = one_model(recording, *learned.windows, data.motion, inputs.lags.drifting, level_wanders);
  Bank bank = learn_drifting(recording, of.global, of.structure, inputs.horizon);
  if (learned.one_motion) bank = with_noise_levels(bank, *learned.one_motion, recording, inputs.horizon);
  const DriftRates& rates = bank.drift.rates;
  const RunningNoise& noise = bank.running_noise;
  progress(data.tell, "drifting: {} lags, {} noise levels, q {:g}, p0 {:g}, leak {:g}, lam {:g}, nu {:g} in {:.2f} s",
           bank.structure.state_lags, noise.levels(), rates.q, rates.p0, rates.leak, noise.lam, noise.nu,
           watch.seconds());
  return bank;
}

namespace {

/// Chooses the terms again, because terms score too well on the runs that chose them. If the split's runs give no
/// terms, those of all training runs are fitted to them.
Bank relearn_nonlinear(const Learning& learned, const Recording& training, const BankInputs& inputs) {
  LinearStructure structure = learned.baseline->structure;
  structure.intercept = inputs.window.intercept;  // a model of differences has none
  structure.centre.clear();                       // terms are functions of the values themselves
  const FoundTerms found = inputs.terms_stated ? FoundTerms() : find_terms(training, structure, inputs.window);
  if (found.terms.empty())
    return learn_nonlinear(training, learned.nonlinear->structure, learned.nonlinear->terms, inputs.bank.em);
  return learn_nonlinear(training, found.structure, found.terms, inputs.bank.em);
}

/// The filters learned without the left-out runs of a split. Not learned again: Q and R of a baseline that is not of
/// the linear stage, and the rates of `drifting`.
Learning learned_on(const Learning& learned, const Recording& training, const BankInputs& inputs, const Bank& bank,
                    const Bank& one_motion) {
  Learning anew;
  anew.bank = bank;
  anew.one_motion = one_motion;
  if (inputs.lags.armax) anew.baseline = learn_armax(training, *inputs.lags.armax, inputs.bank.measurement_variance);
  if (!anew.baseline && learned.baseline) {
    anew.baseline = learned.baseline;
    const LinearStructure& structure = anew.baseline->structure;
    anew.baseline->modes.front().model = unpack(structure, fit_global(training, structure).theta);
  }
  if (learned.noise_only)
    anew.noise_only =
        noise_only_beside(*anew.baseline, inputs.lags.armax.has_value(), training, learned.noise_only->structure);
  if (learned.drifting)
    anew.drifting = relearn_drifting(*learned.drifting, training, fit_global(training, learned.drifting->structure));
  if (learned.nonlinear) anew.nonlinear = relearn_nonlinear(learned, training, inputs);
  return anew;
}

}  // namespace

std::vector<LeftOutRow> score_left_out(const StageData& data, const Learning& learned, const BankInputs& inputs,
                                       const std::vector<Bank>& banks, const std::vector<Bank>& one_motions) {
  if (!inputs.filter) return {};
  const Stopwatch watch;
  const std::vector<ValidationSplit> splits = validation_splits(data.part, inputs.bank.em.folds);
  if (splits.empty() || banks.size() != splits.size() || one_motions.size() != splits.size()) return {};
  std::vector<Index> horizons = inputs.horizon;
  horizons.push_back(1);
  std::vector<std::vector<LearnedFilter>> filters(splits.size());
  tbb::parallel_for(std::size_t{0}, splits.size(), [&](std::size_t s) {
    filters[s] =
        learned_filters(learned_on(learned, splits[s].training, inputs, banks[s], one_motions[s]), *inputs.filter);
  });
  std::vector<std::string> names;
  for (const LearnedFilter& one : filters.front()) names.push_back(one.name);
  std::vector<std::vector<HorizonEvaluation>> forecasts(names.size());
  for (std::size_t s = 0; s < splits.size(); ++s)
    for (std::size_t f = 0; f < names.size(); ++f) {
      const std::vector<Trajectory>& runs = splits[s].left_out.runs;
      const std::size_t first = forecasts[f].size();
      forecasts[f].resize(first + runs.size());
      tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t r) {
        const LearnedFilter& one = filters[s][f];
        forecasts[f][first + r] = evaluate_horizons(one.bank, runs[r], one.options, horizons);
      });
    }
  progress(data.tell, "left out: scored {} filters on training runs, each learned without the scored run, in {:.2f} s",
           names.size(), watch.seconds());
  return left_out_rows(names, forecasts);
}

}  // namespace modebank
