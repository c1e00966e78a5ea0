#include "filter/learn/chain/stages.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/memberships.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/linearise.hpp"
#include "ident/terms/find_terms.hpp"
#include "ident/terms/stated_terms.hpp"
#include "ident/terms/term_rows.hpp"

namespace modebank {

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
  if (is_linear(window)) {
    const std::string unidentifiable =
        unidentifiable_effects(recording, linear_structure(recording.state_count(), recording.input_count(), window));
    if (!unidentifiable.empty()) data.tell(Level::warning, unidentifiable);
  }
  const Stopwatch watch;
  WindowFits windows = own ? fit_windows(recording, window, *own) : fit_windows(recording, window);
  data.tell(Level::progress, fmt::format("windows: {} fitted in {:.2f} s", windows.count(), watch.seconds()));
  return windows;
}

MixtureResult cluster(const StageData& data, const WindowFits& windows, const MixtureInputs& inputs) {
  const Stopwatch watch;
  MixtureResult found = cluster_windows(data.recording, windows, inputs.window, inputs.mixture, inputs.seed);
  const std::string part =
      found.compared > 0 ? ", candidates compared on " + of_all(found.compared, found.clustered) + "," : "";
  data.tell(Level::progress, fmt::format("mixture: {} components from {} windows{} in {:.2f} s",
                                         found.mixture.components(), found.clustered, part, watch.seconds()));
  return found;
}

namespace {

/// One linear model of the training runs.
struct OneModel {
  std::string model;  ///< name of the windows' model, if that model has these lags
  LinearStructure structure;
  GlobalModel global;
};

/// Fits one model with these lags. If no lags are given, uses those of the windows.
OneModel one_model(const Recording& recording, const WindowFits& windows, const MotionModel* motion,
                   const std::optional<StageLags>& lags) {
  OneModel one{windows.model, windows.structure, {}};
  if (lags) {
    one.structure.state_lags = lags->state_lags;
    one.structure.input_lags = lags->input_lags;
    one.structure.input_delay = lags->input_delay;
  }
  const bool of_windows = one.structure == windows.structure;
  one.global = of_windows ? linear_global(recording, windows, motion) : fit_global(recording, one.structure);
  if (!of_windows) one.model = one.structure.lagged() ? "varx" : "linear";
  return one;
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

/// The factor on the competitors' noise; empty if the noise has no factor.
NoiseFactor noise_factor(const Recording& recording, const LinearStructure& structure, const CompetitorInputs& inputs,
                         const Tell& tell) {
  if (!inputs.noise_by_input) return {};
  const Stopwatch watch;
  FoundNoiseFactor found = find_noise_factor(recording, structure, inputs.em.folds, inputs.em.seed);
  if (std::isnan(found.gain)) return {};
  const std::string gain =
      std::isnan(found.standard_error)
          ? fmt::format("gains {:.4f} nats/sample on the runs that chose it", found.gain)
          : fmt::format("gains {:.4f} +- {:.4f} nats/sample on left-out runs", found.gain, found.standard_error);
  tell(Level::progress, fmt::format("noise by input: a factor on all process noise {}: {}, in {:.2f} s", gain,
                                    found.factor.empty() ? "not taken" : "taken", watch.seconds()));
  return std::move(found.factor);
}

/// Fits the terms given in the configuration, even if they do not gain.
FoundTerms take_stated(const Recording& recording, const LinearStructure& structure, const std::string& terms) {
  constexpr Index enough_rows = 200000;
  std::vector<std::string> names = state_names(recording, structure);
  for (const std::string& input : input_names(recording, structure)) names.push_back(input);
  const TermRows rows = gather_term_rows(recording, structure, enough_rows);
  require_transitions(rows.count() > 0);
  FoundTerms found;
  found.structure = structure;
  found.terms = stated_terms(read_terms(terms), names, rows.X);
  return found;
}

std::string gain_words(const FoundTerms& found) {
  if (found.terms_asked > 0)
    return fmt::format("{} terms gain {:.4f} +- {:.4f} nats/sample on halves that did not choose them",
                       found.terms_asked, found.gain, found.gain_standard_error);
  return found.terms.empty() ? "no terms gain" : fmt::format("{} terms as configured", found.terms.count());
}

std::optional<Bank> nonlinear(const Recording& recording, LinearStructure structure, const CompetitorInputs& inputs,
                              bool noise_by_input, const Tell& tell) {
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
  const std::string gain = gain_words(found);
  if (found.terms.empty()) {
    tell(Level::progress, fmt::format("nonlinear: {}: not taken, in {:.2f} s", gain, watch.seconds()));
    return {};
  }
  RefineOptions em = inputs.em;
  em.noise_by_input = noise_by_input;
  Bank bank = learn_nonlinear(recording, found.structure, found.terms, em);
  tell(Level::progress, fmt::format("nonlinear: {}: taken with lags {}, {} noise levels, in {:.2f} s", gain,
                                    lags_of(found.structure), bank.mode_count(), watch.seconds()));
  return bank;
}

}  // namespace

Bank learn_single_filter(const StageData& data, const WindowFits& windows, const CompetitorInputs& inputs) {
  return single_filter(data.recording, one_model(data.recording, windows, data.motion, inputs.lags.linear), inputs,
                       data.tell);
}

CompetitorsPart learn_competitors(const StageData& data, const WindowFits& windows, const CompetitorInputs& inputs) {
  const Recording& recording = data.part;
  if (const Index part = recording.transitions(Role::train), all = data.recording.transitions(Role::train); part < all)
    data.tell(Level::progress, "competitors: learned " + learned_words(part, all));
  const OneModel linear = one_model(recording, windows, data.motion, inputs.lags.linear);
  CompetitorsPart learned;
  learned.baseline = single_filter(recording, linear, inputs, data.tell);
  const NoiseFactor factor = noise_factor(recording, linear.structure, inputs, data.tell);
  learned.noise_only =
      noise_only_beside(*learned.baseline, inputs.lags.armax.has_value(), recording, linear.structure, factor);
  if (inputs.all) learned.nonlinear = nonlinear(recording, linear.structure, inputs, !factor.empty(), data.tell);
  return learned;
}

namespace {

void tell_candidates(const Refinement& refined, const Tell& tell) {
  for (const RefineCandidate& c : refined.candidates)
    tell(Level::detail,
         fmt::format("refine: {:<12} {:>3} modes, Q prior {}: {:.4f} nats/sample on left-out runs, {:.4f} +- {:.4f} "
                     "below the best, after {} iterations{}",
                     c.start, c.modes, c.noise_transitions, c.score, c.loss, c.loss_standard_error, c.iterations,
                     c.selected ? " (chosen)" : ""));
}

void tell_measurement(const Refinement& refined, const Tell& tell) {
  const MeasurementStage& measured = refined.measurement;
  if (measured.failed_starts > 0)
    tell(Level::warning,
         fmt::format("refine: {} of {} searches for R failed{}", measured.failed_starts, measured.starts,
                     measured.failed_starts < measured.starts ? "; the best of the other searches is used"
                                                              : ", so R = 0 is not certain"));
  if (measured.starts > 0)
    tell(Level::progress,
         fmt::format("refine: searched for measurement noise from {} starts, in {:.2f} s{}", measured.starts,
                     measured.seconds, refined.bank.R_standard_error.size() == 0 ? ": found none worth adding" : ""));
  if (!std::isnan(measured.score))
    tell(Level::progress,
         fmt::format("refine: {} iterations with measurement noise: {:.4f} -> {:.4f} nats/sample on left-out runs",
                     measured.iterations, measured.score_before, measured.score));
}

void tell_additions(const Refinement& refined, const Tell& tell) {
  if (const SwitchingStage& s = refined.switching; !std::isnan(s.gain))
    tell(Level::progress,
         fmt::format("refine: switching by state and input gains {:.4f} +- {:.4f} nats/sample on left-out runs{}",
                     s.gain, s.gain_standard_error,
                     s.width > 0.0 ? fmt::format(" (accepted, width {})", s.width) : ": not taken"));
}

}  // namespace

Refinement learn_modes(const StageData& data, const Learning& learned, const BankInputs& inputs) {
  if (inputs.one_model) {
    if (inputs.one_motion) data.tell(Level::progress, "bank: equals baseline, because the time steps differ too much");
    return {*learned.baseline, {}, {}, {}, {}};
  }
  Refinement refined = learn_as_asked(data.recording, *learned.windows, *learned.mixture, inputs.bank,
                                      learned.baseline->R, inputs.filter, data.motion);
  if (inputs.bank.refine == Refine::none)
    data.tell(Level::progress,
              fmt::format("bank: modes of model {} come from the mixture, without refinement", learned.windows->model));
  tell_candidates(refined, data.tell);
  tell_measurement(refined, data.tell);
  tell_additions(refined, data.tell);
  if (const Index learned_from = refined.learned_transitions; learned_from > 0)
    data.tell(Level::progress,
              "refine: learned " + learned_words(learned_from, data.recording.transitions(Role::train)));
  return refined;
}

Refinement learn_one_motion(const StageData& data, const Learning& learned, const BankInputs& inputs) {
  constexpr Index fewest_levels = 8;  // smallest number of noise levels (method: section 6)
  const Stopwatch watch;
  const Recording& recording = data.part;
  const WindowFits& windows = *learned.windows;
  const OneModel one = one_model(recording, windows, data.motion, inputs.lags.one_motion);
  WindowFits own;
  own.structure = one.structure;
  Refinement refined = learn_one_motion(recording, one.structure == windows.structure ? windows : own, one.global,
                                        *learned.bank, learned.baseline->R,
                                        std::max(fewest_levels, learned.mixture->mixture.components()), inputs.bank);
  const Index horizon = *std::max_element(inputs.horizon.begin(), inputs.horizon.end());
  if (inputs.simulate > 0 && horizon > 1 && fit_horizon(recording, inputs.bank.em, horizon, inputs.simulate, refined))
    data.tell(Level::progress, fmt::format("one_motion: errors up to {} samples ahead fit free runs better", horizon));
  data.tell(Level::progress,
            fmt::format("one_motion: {} noise levels in {:.2f} s", refined.bank.mode_count(), watch.seconds()));
  return refined;
}

Bank learn_drifting(const StageData& data, const Learning& learned, const BankInputs& inputs) {
  const Stopwatch watch;
  const Recording& recording = data.part;
  const OneModel of = one_model(recording, *learned.windows, data.motion, inputs.lags.drifting);
  Bank bank = learn_likeliest_drifting(recording, of.global, of.structure, inputs.horizon);
  if (learned.one_motion) bank = with_noise_levels(bank, *learned.one_motion, recording, inputs.horizon);
  const DriftRates& rates = bank.drift.rates;
  const RunningNoise& noise = bank.running_noise;
  data.tell(Level::progress,
            fmt::format(
                "drifting: {} with {} lags, {} noise levels, q {:g}, p0 {:g}, leak {:g}, lam {:g}, nu {:g} in {:.2f} s",
                name_of(bank.drift.wandering), bank.structure.state_lags, noise.levels(), rates.q, rates.p0, rates.leak,
                noise.lam, noise.nu, watch.seconds()));
  return bank;
}

}  // namespace modebank
