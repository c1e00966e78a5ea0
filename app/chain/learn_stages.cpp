#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/chain/judged_runs.hpp"
#include "app/chain/stages.hpp"
#include "filter/judge/scores.hpp"
#include "filter/learn/competitors/drifting.hpp"
#include "filter/learn/competitors/noise_by_input.hpp"
#include "filter/learn/from_mixture/bank_frame.hpp"
#include "filter/learn/from_mixture/passing_windows.hpp"
#include "filter/learn/learn.hpp"
#include "filter/learn/refine/learning_part.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/linearise.hpp"
#include "ident/terms/find_terms.hpp"
#include "ident/terms/stated_terms.hpp"
#include "ident/terms/term_rows.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

GlobalModel linear_global(const Recording& recording, const WindowFits& windows, const FitOptions& window) {
  const auto motion = motion_model(window, recording.state_count(), recording.input_count());
  return modebank::linear_global(recording, windows, motion.get());
}

OneModel one_model(const Recording& recording, const WindowFits& windows, const FitOptions& window,
                   const std::optional<Lags>& lags) {
  OneModel one{windows.model, windows.structure, {}};
  if (lags)
    one.structure = {one.structure.states, one.structure.inputs, one.structure.intercept,
                     (*lags)[0],           (*lags)[1],           (*lags)[2]};
  const bool of_windows = one.structure == windows.structure;
  one.global = of_windows ? linear_global(recording, windows, window) : fit_global(recording, one.structure);
  if (!of_windows) one.model = one.structure.lagged() ? "varx" : "linear";
  return one;
}

namespace {

void tell_of_shrinking(const std::string& whose, const Bank& bank, const Listener& listener) {
  if (bank.shrinking.modes > 0) listener.warning(fmt::format("{}: {}", whose, shrinking_words(bank.shrinking)));
}

DriftingModel drifting(const Recording& recording, const OneModel& of, const CompetitorInputs& inputs,
                       const Listener& listener) {
  const Stopwatch watch;
  DriftingModel model = learn_likeliest_drifting(recording, of.global, of.structure, inputs.horizon);
  listener.progress(fmt::format("drifting: {} with {} lags, q {:g}, p0 {:g}, leak {:g}, lam {:g}, nu {:g} in {:.2f} s",
                                name_of(model.wandering), model.structure.state_lags, model.rates.q, model.rates.p0,
                                model.rates.leak, model.lam, model.nu, watch.seconds()));
  return model;
}

/// The factor on the competitors' noise; empty: none.
NoiseFactor noise_factor(const Recording& recording, const LinearStructure& structure, const CompetitorInputs& inputs,
                         const Listener& listener) {
  if (inputs.noise_by_input == NoiseByInput::none) return {};
  const Stopwatch watch;
  FoundNoiseFactor found = find_noise_factor(recording, structure, inputs.em.folds, inputs.seed);
  if (std::isnan(found.gain)) return {};
  const std::string gain =
      std::isnan(found.standard_error)
          ? fmt::format("gains {:.4f} nats/sample on the runs that chose it", found.gain)
          : fmt::format("gains {:.4f} +- {:.4f} nats/sample left out", found.gain, found.standard_error);
  listener.progress(fmt::format("noise by input: a factor on all process noise {}: {}, in {:.2f} s", gain,
                                found.factor.empty() ? "not taken" : "taken", watch.seconds()));
  return std::move(found.factor);
}

std::string lags_of(const LinearStructure& s) {
  return fmt::format("({}, {}, {})", s.state_lags, s.input_lags, s.input_delay);
}

/// Terms that the configuration states are taken, whatever they gain.
FoundTerms take_stated(const Recording& recording, const LinearStructure& structure, const std::string& terms) {
  constexpr Index enough_rows = 200000;
  std::vector<std::string> names = state_names(recording, structure);
  for (const std::string& input : input_names(recording, structure)) names.push_back(input);
  const TermRows rows = gather_term_rows(recording, structure, enough_rows);
  if (rows.count() == 0) throw DataError("no training run has a transition to learn window.terms from");
  FoundTerms found;
  found.structure = structure;
  found.terms = stated_terms(read_terms(terms), names, rows.X);
  return found;
}

std::string gain_words(const FoundTerms& found) {
  if (found.terms_asked > 0)
    return fmt::format("{} terms gain {:.4f} +- {:.4f} nats/sample on halves that did not choose them",
                       found.terms_asked, found.gain, found.gain_standard_error);
  return found.terms.empty() ? "no terms that gain" : fmt::format("{} terms as stated", found.terms.count());
}

std::optional<Bank> nonlinear(const Recording& recording, const LinearStructure& structure,
                              const CompetitorInputs& inputs, bool noise_by_input, const Listener& listener) {
  if (inputs.terms == "none") return {};
  const Stopwatch watch;
  const FoundTerms found = lists_terms(inputs.terms) ? take_stated(recording, structure, inputs.terms)
                                                     : find_terms(recording, structure, inputs.window);
  for (const TriedTerms& tried : found.tried)
    listener.detail(fmt::format("nonlinear: {} terms with lags {}: {:.4f} nats/sample left out", tried.terms,
                                lags_of(tried.structure), tried.log_score));
  const std::string gain = gain_words(found);
  if (found.terms.empty()) {
    listener.progress(fmt::format("nonlinear: {}: not taken, in {:.2f} s", gain, watch.seconds()));
    return {};
  }
  RefineOptions em = inputs.em;
  em.noise_by_input = noise_by_input;
  Bank bank = learn_nonlinear(recording, found.structure, found.terms, em, inputs.filter);
  tell_of_shrinking("nonlinear", bank, listener);
  listener.progress(fmt::format("nonlinear: {}: taken with lags {}, {} noise levels, in {:.2f} s", gain,
                                lags_of(found.structure), bank.mode_count(), watch.seconds()));
  return bank;
}

}  // namespace

Bank learn_single_filter(const Recording& recording, const OneModel& of, const FilterOptions& filter,
                         const Listener& listener) {
  Baseline baseline = learn_baseline(recording, of.global, of.structure);
  baseline.bank.model = of.model;
  if (baseline.at_bound) listener.progress("baseline: R is at its lower bound: the data show no measurement noise");
  if (!baseline.converged) listener.warning("baseline: its noise did not reach a maximum of the likelihood");
  if (filter.noise == FilterNoise::adaptive)
    baseline.bank.noise_adaptation = most_likely_adaptation(baseline.bank, recording, filter, {});
  return std::move(baseline.bank);
}

Competitors learn_competitors(const Recording& all, const WindowFits& windows, const CompetitorInputs& inputs,
                              const Listener& listener) {
  const std::optional<Recording> part = learning_part(all, inputs.transitions, inputs.seed);
  const Recording& recording = part ? *part : all;
  if (part)
    listener.progress(fmt::format("competitors: learned {}",
                                  learned_words(part->transitions(Role::train), all.transitions(Role::train))));
  const OneModel linear = one_model(recording, windows, inputs.window, inputs.linear);
  Competitors learned{learn_single_filter(recording, linear, inputs.filter, listener), {}, {}};
  learned.drifting =
      drifting(recording, one_model(recording, windows, inputs.window, inputs.drifting), inputs, listener);
  const NoiseFactor factor = noise_factor(recording, linear.structure, inputs, listener);
  learned.noise_only = learn_noise_only(recording, linear.structure, learned.baseline.R, factor);
  if (inputs.filter.noise == FilterNoise::adaptive)
    learned.noise_only.noise_adaptation = most_likely_adaptation(learned.noise_only, recording, inputs.filter, {});
  learned.nonlinear = nonlinear(recording, linear.structure, inputs, !factor.empty(), listener);
  return learned;
}

namespace {

/// The bank, refined if the options say so.
Refinement learn(const LearnedFrom& from, const BankInputs& inputs, const BankOptions& options) {
  const auto motion = motion_model(inputs.window, from.recording.state_count(), from.recording.input_count());
  return learn_as_asked(from.recording, from.windows, from.mixture, options, from.baseline.R, inputs.filter,
                        motion.get());
}

/// What a limit on the number of modes cost: the same bank is learned without it.
std::vector<MergingCost> merging_of(const LearnedFrom& from, const BankInputs& inputs, const Bank& limited) {
  const Index components = from.mixture.mixture.components();
  if (inputs.bank.modes == 0 || components <= inputs.bank.modes) return {};
  BankOptions unlimited = inputs.bank;
  unlimited.modes = 0;
  const Bank whole = learn(from, inputs, unlimited).bank;
  return merging_costs(whole, limited, components, from.recording, inputs.filter.value());
}

std::string worth_of(const LookAheadStage& stage) {
  if (stage.score == stage.score_before) return "taken, no runs are left out to ask";
  const std::string gain = stage.of_errors
                               ? fmt::format("errors of the runs left out {:+.1f} %",
                                             100.0 * (std::sqrt(stage.score / stage.score_before) - 1.0))
                               : fmt::format("{:.4f} -> {:.4f} nats/sample left out", stage.score_before, stage.score);
  return gain + (stage.taken ? "" : ": not taken");
}

void tell_of(const Refinement& refined, const Listener& listener) {
  tell_of_shrinking("refine", refined.bank, listener);
  for (const RefineCandidate& c : refined.candidates)
    listener.detail(fmt::format(
        "refine: {:<12} {:>3} modes, Q prior {}{}: {:.4f} nats/sample left out, {:.4f} +- {:.4f} below the best, after "
        "{} iterations{}",
        c.start, c.modes, c.noise_transitions,
        c.theta_transitions > 0.0 ? fmt::format(", to one motion {:g}", c.theta_transitions) : "", c.score, c.loss,
        c.loss_standard_error, c.iterations, c.selected ? " (chosen)" : ""));
  const MeasurementStage& measured = refined.measurement;
  if (measured.failed_starts > 0)
    listener.warning(fmt::format("refine: {} of {} searches for R failed{}", measured.failed_starts, measured.starts,
                                 measured.failed_starts < measured.starts ? "; the best of the others counts"
                                                                          : ", so R is not known to be none"));
  if (measured.starts > 0)
    listener.progress(fmt::format("refine: measurement noise looked for from {} starts, in {:.2f} s{}", measured.starts,
                                  measured.seconds,
                                  refined.bank.R_standard_error.size() == 0 ? ": none that pays" : ""));
  if (!std::isnan(measured.score))
    listener.progress(fmt::format("refine: {} iterations with measurement noise: {:.4f} -> {:.4f} nats/sample left out",
                                  measured.iterations, measured.score_before, measured.score));
  if (const SwitchingStage& s = refined.switching; !std::isnan(s.gain))
    listener.progress(
        fmt::format("refine: switches that see state and input gain {:.4f} +- {:.4f} nats/sample left out{}", s.gain,
                    s.gain_standard_error,
                    s.width > 0.0 ? fmt::format(" (taken, width {}{})", s.width,
                                                std::isinf(s.memory_sd) ? "" : ", the mode before hardly matters")
                                  : ": not taken"));
  if (const DriftStage& s = refined.drift; !std::isnan(s.gain))
    listener.progress(fmt::format(
        "refine: {} modes that drift (rate {:g}, start {:g}, leak {:g}) gain {:.4f} +- {:.4f} nats/sample left out: {}",
        s.modes, s.rate, s.start, s.leak, s.gain, s.gain_standard_error, s.taken ? "taken" : "not taken"));
  if (const LookAheadStage& ahead = refined.look_ahead; ahead.taken || ahead.score != ahead.score_before)
    listener.progress("refine: fit to predictions up to the look-ahead: " + worth_of(ahead));
}

/// Modes that a mixture makes of windows between two others. Refinement takes them apart.
void warn_of_passing_modes(const LearnedFrom& from, const Bank& bank, const Listener& listener) {
  constexpr double most = 0.75;  // of a true mode's windows about half seem to pass where labels flicker
  const Eigen::VectorXd shares = passing_shares(from.windows, from.mixture);
  for (Index k = 0; k < shares.size(); ++k) {
    const bool screened = std::any_of(bank.screened.begin(), bank.screened.end(),
                                      [&](const ScreenedMode& mode) { return mode.component == k; });
    if (shares(k) > most && !screened)
      listener.warning(
          fmt::format("bank: component {} is no mode of motion of its own: {:.0f} % of its windows seem to "
                      "straddle a switch between others (bank.refine = em takes such modes apart)",
                      k, 100.0 * shares(k)));
  }
}

}  // namespace

LearnedBank learn_modes(const LearnedFrom& from, const BankInputs& inputs, const Listener& listener) {
  if (inputs.one_model) return {from.baseline, {}, MeasuredFit::none, {}};
  Refinement refined = learn(from, inputs, inputs.bank);
  if (inputs.bank.refine == Refine::none)
    listener.progress(fmt::format("bank: the mixture's own modes of model {}, not refined", from.windows.model));
  if (inputs.bank.refine == Refine::none) warn_of_passing_modes(from, refined.bank, listener);
  tell_of(refined, listener);
  if (const Index learned_from = refined.learned_transitions; learned_from > 0)
    listener.progress(
        fmt::format("refine: learned {}", learned_words(learned_from, from.recording.transitions(Role::train))));
  LearnedBank learned{std::move(refined.bank),     {}, refined.measurement.end, {}, refined.learned_transitions,
                      std::move(refined.of_splits)};
  if (inputs.bank.refine == Refine::em) learned.unrefined = std::move(refined.start);
  learned.merging = merging_of(from, inputs, learned.bank);
  return learned;
}

Refinement learn_one_motion(const LearnedFrom& from, const Bank& rival, const BankInputs& inputs,
                            const Listener& listener) {
  constexpr Index fewest_levels = 8;  // noise levels that it may have at least (method: section 6)
  const Stopwatch watch;
  const OneMotionInputs& learned = *inputs.one_motion;
  const std::optional<Recording> part =
      learning_part(from.recording, learned.bank.em.transitions, learned.bank.em.seed);
  const Recording& recording = part ? *part : from.recording;
  const OneModel one = one_model(recording, from.windows, inputs.window, learned.lags);
  const bool of_windows = one.structure == from.windows.structure;
  WindowFits own;
  own.structure = one.structure;
  Refinement refined =
      learn_one_motion(recording, of_windows ? from.windows : own, one.global, rival, from.baseline.R,
                       std::max(fewest_levels, from.mixture.mixture.components()), learned.bank, learned.filter);
  const Bank& bank = refined.bank;
  tell_of_shrinking("one_motion", bank, listener);
  const DriftRates& rates = bank.drift.rates;
  listener.progress(fmt::format("one_motion: {} noise levels{} in {:.2f} s", bank.mode_count(),
                                bank.drift.empty() ? ""
                                                   : fmt::format(", theta drifts (rate {:g}, start {:g}, leak {:g})",
                                                                 rates.q, rates.p0, rates.leak),
                                watch.seconds()));
  return refined;
}

}  // namespace modebank
