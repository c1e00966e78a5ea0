#include "app/text/finding_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/text/judged_runs.hpp"
#include "app/text/number_text.hpp"
#include "ident/data/streams.hpp"

namespace modebank {
namespace {

using app::counted;
using app::likelihood_words;

/// Text such as "6 held-out runs", or "held-out stretch" for one stretch of a drive.
std::string judged(const Finding& finding) {
  const std::string runs = fmt::format("{} {}", words_for(finding.role), noun_of_runs(finding.runs, finding.stretches));
  return finding.runs == 1 ? runs : fmt::format("{} {}", finding.runs, runs);
}

std::string gain_words(double gain, double error) {
  const std::string plus_minus = std::isfinite(error) ? fmt::format(" +- {:.3f}", error) : " of unknown error";
  return fmt::format("{:+.3f}{} nats per sample", gain, plus_minus);
}

/// Sentence on the gain. Example:
/// "switching between 5 linear models predicts the 6 held-out runs better than the best single model (`one_motion`: one
/// linear model with changing noise): each sample is 14.4 % more likely (+0.134 +- 0.040 nats per sample)."
std::string gain_sentence(const Finding& finding, const char* start) {
  const PairedGain* const best = gain_over(finding, finding.best_competitor);
  if (!best) return "";
  const char* const than = best->falls_short()     ? "worse than"
                           : best->is_negligible() ? "no better than"
                                                   : "better than";
  const bool motions = finding.motions > 1 && finding.motions < finding.modes;
  return fmt::format(
      "{}witching between {} predicts the {} {} the best single model (`{}`: {}): each sample is {} ({}).", start,
      motions ? counted(finding.motions, "motion") : counted(finding.modes, "linear model"), judged(finding), than,
      best->competitor, description_of(best->competitor), likelihood_words(finding.gain),
      gain_words(finding.gain, finding.standard_error));
}

std::string gain_words(const PairedGain& gain) {
  return fmt::format("the gain over `{}`, {},", gain.competitor, gain_words(gain.gain, gain.standard_error));
}

/// Text such as "the gain over `one_motion`, +0.849 +- 0.388 nats per sample, may be chance: with 5 runs, only a gain
/// above 0.911 passes".
std::string within_chance_words(const PairedGain& gain, const Finding& finding) {
  const auto count = gain.by_blocks ? static_cast<Eigen::Index>(gain.degrees_of_freedom) + 1 : finding.runs;
  const std::string clusters = fmt::format("{} {}", count, noun_of_runs(count, gain.by_blocks || finding.stretches));
  if (!gain.exceeds())
    return fmt::format("{} may be chance: with {}, only a gain above {:.3f} passes", gain_words(gain), clusters,
                       gain.margin);
  return fmt::format(
      "{} rests on few of the {}: chance gives ranks as high in {:.0f} % of cases (signed-rank test, "
      "at most 5 % passes)",
      gain_words(gain), clusters, 100.0 * gain.rank_p);
}

std::string why_not_told(const Finding& finding) {
  switch (doubt_of(finding)) {
    case Doubt::nothing_held_out:
      return "no run was held out";
    case Doubt::no_competitor:
      return "no competitor was scored";
    case Doubt::few_samples:
      return fmt::format("too few independent samples leave the error of the gain over `{}` unknown",
                         std::find_if(finding.gains.begin(), finding.gains.end(), [](const PairedGain& gain) {
                           return !std::isfinite(gain.margin);
                         })->competitor);
    case Doubt::small_gain:
      return fmt::format("{} is less than the {:.2g} that counts", gain_words(*least_beaten(finding)),
                         least_beaten(finding)->least_gain);
    case Doubt::short_stays:
      return fmt::format(
          "{} last {:.3g} samples on average ({:.0f} or more passes), and noisy inputs or a delay that differs "
          "between runs look like shorter ones",
          finding.motions < finding.modes ? "motions" : "modes", finding.stay, finding.stay_asked);
    case Doubt::within_chance:
      break;
  }
  return within_chance_words(*least_beaten(finding), finding);
}

/// Text such as "78 % of the samples of y repeat the one before; ..."
std::string repeating_words(const Finding& finding) {
  std::vector<std::string> reasons;
  for (const Resolution& state : finding.repeating)
    reasons.push_back(fmt::format("{:.0f} % of the samples of {} repeat the one before (at most {:.0f} % passes)",
                                  100 * state.repeated, state.state, 100 * repeated_share));
  return fmt::format("{}", fmt::join(reasons, "; "));
}

std::string not_comparable_words(const Finding& finding) {
  return fmt::format(
      "The log scores of the {} measure rounding rather than motion, so modes of motion are not judged: {}.",
      judged(finding), repeating_words(finding));
}

/// Text such as "One linear model predicts the 2 held-out runs up to rounding: ..."
std::string without_noise_words(const Finding& finding) {
  std::vector<std::string> coefficients;
  for (const auto& [name, value] : finding.coefficients) coefficients.push_back(fmt::format("{} {:.6g}", name, value));
  return fmt::format(
      "One linear model predicts the {} up to rounding, so scores, bands and modes have no meaning. Its coefficients, "
      "of the change per sample: {}.",
      judged(finding), fmt::join(coefficients, ", "));
}

std::string one_mode_words(const Finding& finding) {
  if (finding.without_noise) return without_noise_words(finding);
  const char* const one = finding.modes < 2          ? "mode"
                          : std::isnan(finding.stay) ? "motion, whose noise changes"
                                                     : "motion that lasts five samples or more";
  const std::string text = fmt::format("The bank has one {}: no modes of motion.", one);
  if (finding.repeating.empty()) return text;
  return text + fmt::format(" Its log scores measure rounding rather than motion: {}.", repeating_words(finding));
}

std::string not_yet_words(const Finding& finding) {
  if (finding.pattern.told())
    return fmt::format(
        "Modes of motion are not judged yet: the bank's errors follow a pattern. Lags would gain {} on training runs; "
        "`--window.model auto` searches for them.",
        gain_words(finding.pattern.gain, finding.pattern.standard_error));
  return fmt::format(
      "Modes of motion are not judged yet: time steps scatter by {:.0f} % of their median (at most {:.0f} % passes), "
      "and a model holds for one step length.",
      100 * finding.step_scatter, 100 * most_step_scatter);
}

std::string no_evidence_words(const Finding& finding) {
  if (finding.best_competitor.empty()) return "No evidence for modes of motion.";
  return "No evidence for modes of motion:" + gain_sentence(finding, " s");
}

std::string answer_words(const Finding& finding) {
  switch (finding.answer) {
    case Answer::one_mode:
      return one_mode_words(finding);
    case Answer::not_comparable:
      return not_comparable_words(finding);
    case Answer::cannot_tell:
      return fmt::format("Cannot tell whether the {} {} modes of motion: {}.", judged(finding),
                         finding.runs == 1 ? "has" : "have", why_not_told(finding)) +
             gain_sentence(finding, " S");
    case Answer::no_evidence:
      return no_evidence_words(finding);
    case Answer::evidence:
      return gain_sentence(finding, "S") +
             (finding.terms_asked ? "" : " A single nonlinear model can give the same gain.");
    case Answer::not_yet:
      return not_yet_words(finding);
  }
  return "";
}

}  // namespace

std::string finding_text(const Finding& finding) {
  const std::string equation = finding.equations.empty() ? "" : " `modebank show ARCHIVE` prints its equation.";
  return answer_words(finding) + equation;
}

}  // namespace modebank
