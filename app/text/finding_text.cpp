#include "app/text/finding_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/text/judged_runs.hpp"

namespace modebank {
namespace {

std::string counted(Eigen::Index count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string where(const Finding& finding) {
  return fmt::format("{} {} run{}", finding.runs, words_for(finding.role), finding.runs == 1 ? "" : "s");
}

std::string shows(const Finding& finding) { return where(finding) + (finding.runs == 1 ? " shows" : " show"); }

/// " (error from 12 blocks of the one run)", where runs are too few to be what the error is clustered by.
std::string blocks_words(const Finding& finding) {
  for (const PairedGain& gain : finding.gains)
    if (gain.competitor == finding.best_competitor && gain.by_blocks && std::isfinite(gain.standard_error))
      return fmt::format(" (error from {:.0f} blocks of the {})", gain.degrees_of_freedom + 1.0,
                         finding.runs == 1 ? "one run" : fmt::format("{} runs", finding.runs));
  return "";
}

/// " The bank of 5 modes gains +0.134 +- 0.040 nats per sample over one_motion (...), its best competitor."
std::string least_gain_words(const Finding& finding) {
  if (finding.best_competitor.empty()) return "";
  const std::string error =
      std::isfinite(finding.standard_error) ? fmt::format(" +- {:.3f}", finding.standard_error) : " (of unknown error)";
  return fmt::format(" The bank of {} gains {:+.3f}{} nats per sample over {} ({}), its best competitor{}.",
                     counted(finding.modes, "mode"), finding.gain, error, finding.best_competitor,
                     description_of(finding.best_competitor, finding.one_motion_drifts), blocks_words(finding));
}

/// What describes the runs instead, better or as well.
std::string instead_words(const Finding& finding) {
  if (finding.better_description.empty()) return "";
  const bool better = std::any_of(finding.gains.begin(), finding.gains.end(), [&](const PairedGain& gain) {
    return gain.competitor == finding.better_description && gain.falls_short();
  });
  // The best one was named before; a simpler one that is as good states what it costs.
  const std::string loss = finding.better_description == finding.best_competitor
                               ? ""
                               : fmt::format(", the simplest about as good as {} ({:+.3g} nats per sample)",
                                             finding.best_competitor, -finding.description_loss);
  // Only a gain beyond its margin is known: what cannot be told apart may be as good, or not.
  return fmt::format(" These runs {} by {} ({}){}.",
                     !better                                 ? "may be described as well"
                     : finding.answer == Answer::cannot_tell ? "may be described better"
                                                             : "are described better",
                     description_of(finding.better_description, finding.one_motion_drifts), finding.better_description,
                     loss);
}

std::string gain_words(const PairedGain& gain) {
  return fmt::format("the gain over {}, {:+.3f} +- {:.3f} nats per sample,", gain.competitor, gain.gain,
                     gain.standard_error);
}

/// "the gain over one_motion, +0.849 +- 0.388 nats per sample, does not exceed what chance makes of 5 runs (0.911)"
std::string within_chance_words(const PairedGain& gain, Eigen::Index runs) {
  const std::string clusters =
      gain.by_blocks ? counted(static_cast<Eigen::Index>(gain.degrees_of_freedom) + 1, "block") : counted(runs, "run");
  if (!gain.exceeds())
    return fmt::format("{} does not exceed what chance makes of {} ({:.3f})", gain_words(gain), clusters, gain.margin);
  return fmt::format(
      "{} rests on few of the {}: ranks as high come by chance in {:.0f} % (signed-rank test, 5 % asked)",
      gain_words(gain), clusters, 100.0 * gain.rank_p);
}

std::string why_not_told(const Finding& finding) {
  switch (doubt_of(finding)) {
    case Doubt::nothing_held_out:
      return "nothing was held out";
    case Doubt::no_competitor:
      return "no competitor was scored";
    case Doubt::few_samples:
      return fmt::format("there are too few independent samples to know the error of the gain over {}",
                         std::find_if(finding.gains.begin(), finding.gains.end(), [](const PairedGain& gain) {
                           return !std::isfinite(gain.margin);
                         })->competitor);
    case Doubt::errors_unknown:
      return "the standard errors of the modes' parameters are not known, so that the modes may be alike";
    case Doubt::small_gain:
      return fmt::format("{} is less than the {:g} that counts", gain_words(*least_beaten(finding)), negligible_gain);
    case Doubt::short_stays:
      return fmt::format(
          "modes stay {:.3g} samples in the mean, and noisy inputs or a delay that differs between runs look like "
          "modes "
          "that stay fewer than {:.0f}",
          finding.stay, finding.stay_asked);
    case Doubt::within_chance:
      break;
  }
  return within_chance_words(*least_beaten(finding), finding.runs);
}

/// "78 % of the samples of y repeat the one before; ..."
std::string coarse_reasons(const Finding& finding) {
  std::vector<std::string> reasons;
  for (const Resolution& state : finding.coarse)
    reasons.push_back(
        state.repeated > repeated_share
            ? fmt::format("{:.0f} % of the samples of {} repeat the one before", 100 * state.repeated, state.state)
            : fmt::format("{} comes in steps of {:.3g}, predictions are uncertain by {:.3g}", state.state,
                          state.quantum, state.innovation_sd));
  return fmt::format("{}", fmt::join(reasons, "; "));
}

std::string coarse_words(const Finding& finding) {
  return fmt::format(
      "Whether {} modes of motion is not judged by log score: {}, so that a density says more about the "
      "measurement than about the motion.",
      shows(finding), coarse_reasons(finding));
}

/// "One linear model describes the 2 held-out runs without noise: ..."
std::string without_noise_words(const Finding& finding) {
  std::vector<std::string> coefficients;
  for (const auto& [name, value] : finding.coefficients) coefficients.push_back(fmt::format("{} {:.6g}", name, value));
  return fmt::format(
      "One linear model describes the {} without noise: what it leaves is rounding, so that scores, bands and modes "
      "have "
      "no meaning. Its coefficients, of the change per sample: {}.",
      where(finding), fmt::join(coefficients, ", "));
}

std::string one_mode_words(const Finding& finding) {
  if (finding.without_noise) return without_noise_words(finding);
  std::string text = "The bank has one mode, so modes of motion are not in question.";
  if (finding.coarse.empty()) return text + instead_words(finding);
  return text + fmt::format(" Its log scores say little: {}.", coarse_reasons(finding));
}

/// "Over noise_only one nonlinear motion gains +0.210 nats per sample, the bank +0.450."
std::string both_words(const Finding& finding) {
  if (finding.over_linear.empty()) return "";
  return fmt::format(" Over {} one nonlinear motion gains {:+.3f} nats per sample, the bank of {} {:+.3f}.",
                     finding.over_linear, finding.nonlinear_over_linear, counted(finding.modes, "mode"),
                     finding.bank_over_linear);
}

std::string not_yet_words(const Finding& finding) {
  if (finding.pattern.told())
    return fmt::format(
        "Modes of motion are not judged yet: the bank's errors follow a pattern. Lags would gain {:.3g} +- {:.2g} nats "
        "per sample on training runs; `--window.model auto` looks for them.",
        finding.pattern.gain, finding.pattern.standard_error);
  return fmt::format(
      "Modes of motion are not judged yet: steps scatter by {:.0f} % of their median, and the model holds for one step "
      "length.",
      100 * finding.step_scatter);
}

std::string answer_words(const Finding& finding) {
  switch (finding.answer) {
    case Answer::one_mode:
      return one_mode_words(finding);
    case Answer::not_comparable:
      return coarse_words(finding);
    case Answer::cannot_tell:
      return fmt::format("Whether {} modes of motion cannot be told: {}.", shows(finding), why_not_told(finding)) +
             least_gain_words(finding) + instead_words(finding);
    case Answer::no_evidence:
      return fmt::format("{}{} no evidence for modes of motion.",
                         finding.modes_differ || !finding.errors_known
                             ? ""
                             : "The modes do not differ in their parameters beyond their errors: ",
                         shows(finding)) +
             least_gain_words(finding) + instead_words(finding);
    case Answer::evidence:
      return fmt::format("{} evidence for modes of motion: several linear models describe them better than one does.{}",
                         shows(finding), finding.terms_asked ? "" : " A single nonlinear motion would look the same.") +
             least_gain_words(finding);
    case Answer::not_yet:
      return not_yet_words(finding);
  }
  return "";
}

std::string mean_words(const BetterMean& mean) {
  const std::string when = mean.horizon == 0   ? "in free run"
                           : mean.horizon == 1 ? "one step ahead"
                                               : fmt::format("{} samples ahead", mean.horizon);
  return fmt::format("{}{} (RMSE {:.4g}, the bank {:.4g}; {})", when, mean.state.empty() ? "" : " in " + mean.state,
                     mean.rmse, mean.rmse_bank, mean.competitor);
}

std::string better_means_words(const Finding& finding) {
  if (finding.better_means.empty()) return "";
  std::vector<std::string> means;
  for (const BetterMean& mean : finding.better_means) means.push_back(mean_words(mean));
  return fmt::format(" A competitor predicts the mean better {}.", fmt::join(means, ", "));
}

}  // namespace

std::string finding_text(const Finding& finding) {
  const std::string equation = finding.equations.empty() ? "" : " `modebank show ARCHIVE` prints its equation.";
  return answer_words(finding) + both_words(finding) + equation + better_means_words(finding);
}

}  // namespace modebank
