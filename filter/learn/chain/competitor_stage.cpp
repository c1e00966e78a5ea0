#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "filter/learn/chain/armax_bank.hpp"
#include "filter/learn/chain/stages.hpp"
#include "filter/learn/competitors/noise_by_input.hpp"
#include "filter/learn/from_mixture/bank_frame.hpp"
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

namespace {

/// The factor on the competitors' noise; empty if the noise has no factor.
NoiseFactor noise_factor(const Recording& recording, const LinearStructure& structure, const CompetitorInputs& inputs,
                         const Progress& progress) {
  if (inputs.noise_by_input == NoiseByInput::none) return {};
  const Stopwatch watch;
  FoundNoiseFactor found = find_noise_factor(recording, structure, inputs.em.folds, inputs.seed);
  if (std::isnan(found.gain)) return {};
  const std::string gain =
      std::isnan(found.standard_error)
          ? fmt::format("gains {:.4f} nats/sample on the runs that chose it", found.gain)
          : fmt::format("gains {:.4f} +- {:.4f} nats/sample on left-out runs", found.gain, found.standard_error);
  progress.progress(fmt::format("noise by input: a factor on all process noise {}: {}, in {:.2f} s", gain,
                                found.factor.empty() ? "not taken" : "taken", watch.seconds()));
  return std::move(found.factor);
}

std::string lags_of(const LinearStructure& s) {
  return fmt::format("({}, {}, {})", s.state_lags, s.input_lags, fmt::join(s.input_delay.listed(), " "));
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
                              bool noise_by_input, const Progress& progress) {
  if (inputs.terms == "none") return {};
  structure.centre.clear();  // terms are functions of the values themselves
  const Stopwatch watch;
  const FoundTerms found = lists_terms(inputs.terms) ? take_stated(recording, structure, inputs.terms)
                                                     : find_terms(recording, structure, inputs.window);
  for (const TriedTerms& tried : found.tried)
    progress.detail(fmt::format("nonlinear: {} terms with lags {}: {:.4f} nats/sample on left-out rows", tried.terms,
                                lags_of(tried.structure), tried.log_score));
  const std::string gain = gain_words(found);
  if (found.terms.empty()) {
    progress.progress(fmt::format("nonlinear: {}: not taken, in {:.2f} s", gain, watch.seconds()));
    return {};
  }
  RefineOptions em = inputs.em;
  em.noise_by_input = noise_by_input;
  Bank bank = learn_nonlinear(recording, found.structure, found.terms, em);
  progress.progress(fmt::format("nonlinear: {}: taken with lags {}, {} noise levels, in {:.2f} s", gain,
                                lags_of(found.structure), bank.mode_count(), watch.seconds()));
  return bank;
}

}  // namespace

Bank learn_single_filter(const Recording& recording, const OneModel& of, const CompetitorInputs& inputs,
                         const Progress& progress) {
  if (inputs.single)
    if (std::optional<Bank> bank = learn_single(recording, *inputs.single)) return *std::move(bank);
  Baseline baseline = learn_baseline(recording, of.global, of.structure);
  baseline.bank.model = of.model;
  if (of.structure.inputs > 0)
    baseline.bank.modes.front().response =
        step_response(of.structure, of.global.theta, of.global.covariance,
                      of.structure.input_delay.by_input(of.structure.inputs), baseline.bank.dt_s);
  if (baseline.at_bound) progress.progress("baseline: R is at its lower bound: the data show no measurement noise");
  if (!baseline.converged)
    progress.warning("baseline: the search for its noise did not reach a maximum of the likelihood");
  return std::move(baseline.bank);
}

std::optional<Bank> learn_single(const Recording& recording, const SingleModel& single) {
  std::optional<Eigen::VectorXd> R;
  if (single.measurement_variance)
    R.emplace(Eigen::VectorXd::Constant(recording.state_count(), *single.measurement_variance));
  return learn_armax(recording, single.structure, R);
}

CompetitorsPart learn_competitors(const Recording& all, const WindowFits& windows, const MotionModel* motion,
                                  const CompetitorInputs& inputs, const Progress& progress) {
  const std::optional<Recording> part = learning_part(all, inputs.transitions, inputs.seed);
  const Recording& recording = part ? *part : all;
  if (part)
    progress.progress(fmt::format("competitors: learned {}",
                                  learned_words(part->transitions(Role::train), all.transitions(Role::train))));
  const OneModel linear = one_model(recording, windows, motion, inputs.linear);
  CompetitorsPart learned;
  learned.baseline = learn_single_filter(recording, linear, inputs, progress);
  const NoiseFactor factor = noise_factor(recording, linear.structure, inputs, progress);
  learned.noise_only = inputs.single && factor.empty()
                           ? noise_levels_of(*learned.baseline, recording)
                           : learn_noise_only(recording, linear.structure, learned.baseline->R, factor);
  if (inputs.all) learned.nonlinear = nonlinear(recording, linear.structure, inputs, !factor.empty(), progress);
  return learned;
}

}  // namespace modebank
