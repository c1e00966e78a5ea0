#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "filter/learn/chain/stages.hpp"
#include "filter/learn/competitors/drifting.hpp"
#include "filter/learn/learn.hpp"
#include "filter/learn/refine/learning_part.hpp"
#include "ident/fit/fit_windows.hpp"

namespace modebank {
namespace {

std::string worth_of(const LookAheadStage& stage) {
  if (stage.score == stage.score_before) return "accepted without a test, because no runs are left out";
  const std::string gain =
      stage.of_errors ? fmt::format("errors on left-out runs change by {:+.1f} %",
                                    100.0 * (std::sqrt(stage.score / stage.score_before) - 1.0))
                      : fmt::format("{:.4f} -> {:.4f} nats/sample on left-out runs", stage.score_before, stage.score);
  return gain + (stage.taken ? "" : ": not taken");
}

void tell_of(const Refinement& refined, const Progress& progress) {
  for (const RefineCandidate& c : refined.candidates)
    progress.detail(
        fmt::format("refine: {:<12} {:>3} modes, Q prior {}{}: {:.4f} nats/sample on left-out runs, {:.4f} +- {:.4f} "
                    "below the best, after {} iterations{}",
                    c.start, c.modes, c.noise_transitions,
                    c.theta_transitions > 0.0 ? fmt::format(", to one motion {:g}", c.theta_transitions) : "", c.score,
                    c.loss, c.loss_standard_error, c.iterations, c.selected ? " (chosen)" : ""));
  const MeasurementStage& measured = refined.measurement;
  if (measured.failed_starts > 0)
    progress.warning(fmt::format("refine: {} of {} searches for R failed{}", measured.failed_starts, measured.starts,
                                 measured.failed_starts < measured.starts ? "; the best of the other searches is used"
                                                                          : ", so R = 0 is not certain"));
  if (measured.starts > 0)
    progress.progress(fmt::format("refine: searched for measurement noise from {} starts, in {:.2f} s{}",
                                  measured.starts, measured.seconds,
                                  refined.bank.R_standard_error.size() == 0 ? ": found none worth adding" : ""));
  if (!std::isnan(measured.score))
    progress.progress(
        fmt::format("refine: {} iterations with measurement noise: {:.4f} -> {:.4f} nats/sample on left-out runs",
                    measured.iterations, measured.score_before, measured.score));
  if (const SwitchingStage& s = refined.switching; !std::isnan(s.gain))
    progress.progress(
        fmt::format("refine: switching by state and input gains {:.4f} +- {:.4f} nats/sample on left-out runs{}",
                    s.gain, s.gain_standard_error,
                    s.width > 0.0 ? fmt::format(" (accepted, width {}{})", s.width,
                                                std::isinf(s.memory_sd) ? "" : ", the previous mode hardly matters")
                                  : ": not taken"));
  if (const LookAheadStage& ahead = refined.look_ahead; ahead.taken || ahead.score != ahead.score_before)
    progress.progress("refine: fit to predictions up to bank.look_ahead samples ahead: " + worth_of(ahead));
}

}  // namespace

Refinement learn_modes(const LearnedFrom& from, const BankInputs& inputs, const Progress& progress) {
  if (inputs.one_model) return {from.baseline, {}, {}, {}, {}};
  Refinement refined = learn_as_asked(from.recording, from.windows, from.mixture, inputs.bank, from.baseline.R,
                                      inputs.filter, from.motion);
  if (inputs.bank.refine == Refine::none)
    progress.progress(
        fmt::format("bank: modes of model {} come from the mixture, without refinement", from.windows.model));
  tell_of(refined, progress);
  if (const Index learned_from = refined.learned_transitions; learned_from > 0)
    progress.progress(
        fmt::format("refine: learned {}", learned_words(learned_from, from.recording.transitions(Role::train))));
  return refined;
}

Refinement learn_one_motion(const LearnedFrom& from, const Bank& rival, const BankInputs& inputs,
                            const Progress& progress) {
  constexpr Index fewest_levels = 8;  // smallest number of noise levels (method: section 6)
  const Stopwatch watch;
  const OneMotionInputs& learned = *inputs.one_motion;
  const std::optional<Recording> part =
      learning_part(from.recording, learned.bank.em.transitions, learned.bank.em.seed);
  const Recording& recording = part ? *part : from.recording;
  const OneModel one = one_model(recording, from.windows, from.motion, learned.lags);
  const bool of_windows = one.structure == from.windows.structure;
  WindowFits own;
  own.structure = one.structure;
  Refinement refined = learn_one_motion(recording, of_windows ? from.windows : own, one.global, rival, from.baseline.R,
                                        std::max(fewest_levels, from.mixture.mixture.components()), learned.bank);
  progress.progress(fmt::format("one_motion: {} noise levels in {:.2f} s", refined.bank.mode_count(), watch.seconds()));
  return refined;
}

Bank learn_drifting(const LearnedFrom& from, const std::optional<Bank>& one_motion, const BankInputs& inputs,
                    const Progress& progress) {
  const Stopwatch watch;
  const DriftingInputs& asked = *inputs.drifting;
  const RefineOptions& em = inputs.bank.em;
  const std::optional<Recording> part = learning_part(from.recording, em.transitions, em.seed);
  const Recording& recording = part ? *part : from.recording;
  const OneModel of = one_model(recording, from.windows, from.motion, asked.lags);
  Bank bank = learn_likeliest_drifting(recording, of.global, of.structure, asked.horizon);
  if (one_motion) bank = with_noise_levels(bank, *one_motion, recording, asked.horizon);
  const DriftRates& rates = bank.drift.rates;
  const RunningNoise& noise = bank.running_noise;
  progress.progress(fmt::format(
      "drifting: {} with {} lags, {} noise levels, q {:g}, p0 {:g}, leak {:g}, lam {:g}, nu {:g} in {:.2f} s",
      name_of(bank.drift.wandering), bank.structure.state_lags, noise.levels(), rates.q, rates.p0, rates.leak,
      noise.lam, noise.nu, watch.seconds()));
  return bank;
}

}  // namespace modebank
