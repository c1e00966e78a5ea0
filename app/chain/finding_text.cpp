#include "app/chain/finding_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/chain/judged_runs.hpp"

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
  // A reader has just been told of the best one, which is another where a simpler one scores as well.
  const std::string apart = finding.better_description == finding.best_competitor
                                ? ""
                                : ", the simplest that is not told apart from " + finding.best_competitor;
  // Only a gain beyond its margin is known: what cannot be told apart may be as good, or not.
  return fmt::format(" These runs {} by {} ({}){}.",
                     !better                                 ? "may be described as well"
                     : finding.answer == Answer::cannot_tell ? "may be described better"
                                                             : "are described better",
                     description_of(finding.better_description, finding.one_motion_drifts), finding.better_description,
                     apart);
}

std::string why_not_told(const Finding& finding) {
  if (!finding.held_out()) return "nothing was held out";
  if (finding.gains.empty()) return "no competitor was scored";
  for (const PairedGain& gain : finding.gains)
    if (!std::isfinite(gain.margin)) return "there are too few samples to know the error of a gain";
  return "the gain does not exceed what chance makes of so few runs";
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

std::string one_mode_words(const Finding& finding) {
  std::string text = "The bank has one mode, so modes of motion are not in question.";
  if (finding.coarse.empty()) return text + instead_words(finding);
  return text + fmt::format(" Its log scores say little: {}.", coarse_reasons(finding));
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
      return fmt::format(
                 "{}{} no evidence for modes of motion.",
                 finding.modes_differ ? "" : "The modes do not differ in their parameters beyond their errors: ",
                 shows(finding)) +
             least_gain_words(finding) + instead_words(finding);
    case Answer::evidence:
      return fmt::format(
                 "{} evidence for modes of motion: several linear models describe them better than one does (a "
                 "motion that is nonlinear would show so, too).",
                 shows(finding)) +
             least_gain_words(finding);
    case Answer::not_yet:
      return fmt::format(
          "Modes of motion are not judged yet: steps scatter by {:.0f} % of their median, and the model holds for one "
          "step length.",
          100 * finding.step_scatter);
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

std::string finding_text(const Finding& finding) { return answer_words(finding) + better_means_words(finding); }

}  // namespace modebank
