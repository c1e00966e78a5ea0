#include "app/text/next_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "app/text/judged_runs.hpp"
#include "app/text/named_forecasts.hpp"
#include "app/text/warnings.hpp"
#include "filter/judge/decide/diagnostics.hpp"
#include "ident/fit/window_length.hpp"
#include "ident/lag/structure.hpp"
#include "io/import/split.hpp"

namespace modebank::app {
namespace {

/// Number of restarts to advise. If it does not help, a larger number does not help either.
constexpr int many_restarts = 20;

struct Situation {
  const Archive& archive;
  const Settings& settings;
  const Finding& finding;
  const DiagnosticsRow& bank;  ///< row of the whole filter on the judged runs
  std::vector<Warning> warnings;

  std::string setting(const std::string& key) const {
    const auto found = settings.find(key);
    return found == settings.end() ? std::string() : found->second;
  }
  bool answers(Answer answer) const { return finding.answer == answer; }
};

struct Rule {
  bool (*applies)(const Situation&);
  std::string (*advice)(const Situation&);
};

bool warns(const Situation& s, WarningKind kind) {
  return std::any_of(s.warnings.begin(), s.warnings.end(), [kind](const Warning& w) { return w.kind == kind; });
}

int state_lags(const Situation& s) { return std::atoi(s.setting("window.state_lags").c_str()); }

/// Number of samples that are dropped between blocks of a run.
Index window_and_lags(const Situation& s) {
  const Index lags = s.setting("window.state_lags") == "auto" ? usual_lags : state_lags(s);
  const std::string length = s.setting("window.length");
  return (length == "auto" ? shortest_automatic_length : std::atoi(length.c_str())) + lags;
}

bool is_uncertain_wrongly(const Situation& s) {
  return s.bank.verdict == Calibration::overconfident || s.bank.verdict == Calibration::underconfident ||
         reason_of(s.bank) == CalibrationReason::nis;
}

/// Whether few restarts agree. This applies only to a bank made directly from the mixture, because refinement has its
/// own starts.
bool has_few_agreeing_restarts(const Situation& s) {
  if (!s.archive.mixture_makes_bank() || std::atoi(s.setting("mixture.restarts").c_str()) >= many_restarts)
    return false;
  const auto& all = s.archive.mixture->candidates;
  return std::any_of(all.begin(), all.end(),
                     [](const Candidate& c) { return c.selected && 2 * c.agreeing_restarts < c.restarts; });
}

/// Advice such as "ready: use the simpler one_motion (one linear model with changing noise): `modebank track ARCHIVE
/// ...`".
std::string use_simpler(const Situation& s, const std::string& simpler, const std::string& why) {
  return fmt::format("ready: use the simpler {0} ({1}){2}: `modebank track ARCHIVE --track.filter {0}`", simpler,
                     description_of(simpler, s.archive.one_motion_drifts()), why);
}

/// Advice such as "record about 9 more runs like these". Errors and margins decrease with the square root of the number
/// of runs.
std::string more_runs(const Situation& s) {
  constexpr double too_many = 20.0;  // largest advised number of runs, relative to the present number
  const char* const and_repeat = ", and repeat with them: `modebank run CONFIG`; --data.test holds out more";
  const Finding& finding = s.finding;
  const bool stretches = s.archive.recording && are_stretches(*s.archive.recording);
  const PairedGain* const least = least_beaten(finding);
  if (!least)
    return fmt::format("record longer runs, and more than {} {}{}", finding.runs, noun_of_runs(finding.runs, stretches),
                       and_repeat);
  const double times = std::pow(std::max(least->margin / least->gain, 1.0), 2.0);
  if (times > too_many)
    return fmt::format(
        "the data cannot tell: so small a gain needs over {0:.0f} times as many runs; {1} predicts as well: "
        "`modebank track ARCHIVE --track.filter {1}`",
        too_many, least->competitor);
  const double runs = std::ceil((times - 1.0) * static_cast<double>(finding.runs));
  return fmt::format("record {0} {3} like these, enough to confirm the gain over {1}{2}",
                     runs > 1.0 ? fmt::format("about {:.0f} more", runs) : "one more", least->competitor, and_repeat,
                     noun_of_runs(runs > 1.0 ? 2 : 1, stretches));
}

std::string advice_on_doubt(const Situation& s) {
  const Doubt doubt = doubt_of(s.finding);
  if (doubt == Doubt::small_gain) return use_simpler(s, least_beaten(s.finding)->competitor, ", which is as good");
  if (doubt == Doubt::short_stays)
    return "the data cannot tell modes this short from noisy inputs; to predict, use them all the same: `modebank "
           "track "
           "ARCHIVE`";
  if (doubt != Doubt::errors_unknown) return more_runs(s);
  if (std::atoi(s.setting("bank.look_ahead").c_str()) > 1)
    return "compute standard errors, by which modes are told apart: `modebank run CONFIG --bank.look_ahead 1`";
  return "leave out inputs that hardly vary, since they leave modes without standard errors: `modebank check CONFIG` "
         "names them";
}

/// Advice for a pattern that remains in the errors after a search for lags.
std::string left_pattern(const Situation& s) {
  const std::vector<NamedForecast> named = named_forecasts(s.archive);
  return fmt::format(
      "ready: to predict, use `modebank track ARCHIVE --track.filter {}`; more lags do not remove the pattern that is "
      "left in the errors",
      named.empty() ? "bank" : named.front().filter);
}

/// Rules in order of importance: first faults that make all numbers wrong, last possible improvements.
/// docs/howto/troubleshooting.md has the same list.
const Rule rules[] = {
    {[](const Situation& s) { return warns(s, WarningKind::failed_windows); },
     [](const Situation&) -> std::string {
       return "find the wild samples, for some windows have no finite fit: `modebank check CONFIG` names them";
     }},
    {[](const Situation& s) { return s.answers(Answer::not_yet) && !s.finding.pattern.told(); },
     [](const Situation&) -> std::string {
       return "log at even steps, for steps that scatter look like modes: `modebank check CONFIG` shows the steps";
     }},
    {[](const Situation& s) { return s.finding.without_noise; },
     [](const Situation&) -> std::string {
       return "ready: write the coefficients by `modebank export ARCHIVE --to json --track.filter baseline`";
     }},
    {[](const Situation& s) { return s.answers(Answer::not_comparable); },
     [](const Situation& s) -> std::string {
       const bool by_intervals = !s.setting("data.quantum").empty() && s.setting("data.quantum") != "none";
       return std::string(
                  "measure more finely, or compare the RMSE: `modebank check CONFIG` names what repeats or is rounded, "
                  "and the data.rate_hz that leaves it out") +
              (by_intervals ? "" : "; for rounded values `modebank run CONFIG --data.quantum auto` compares intervals");
     }},
    {[](const Situation& s) { return !s.finding.held_out(); },
     [](const Situation& s) {
       if (s.archive.recording && s.archive.recording->runs.size() == 1)
         return fmt::format(
             "hold out a part of the run, for only that can be evidence: `modebank run CONFIG --data.split "
             "'{}'`",
             proposed_split(s.archive.recording->runs.front().samples(), window_and_lags(s)));
       return std::string(
           "hold out every other run, for only held-out runs can be evidence: `modebank run CONFIG "
           "--data.train ''`");
     }},
    {[](const Situation& s) { return s.finding.pattern.told(); },
     [](const Situation& s) {
       if (s.setting("window.model") != "auto")
         return std::string("errors follow a pattern, so add lags: `modebank run CONFIG --window.model auto`");
       if (s.setting("data.lag_s") != "auto")
         return std::string("errors follow a pattern, so correct late stamps: `modebank run CONFIG --data.lag_s auto`");
       return left_pattern(s);
     }},
    {[](const Situation& s) { return s.answers(Answer::cannot_tell); }, advice_on_doubt},
    {[](const Situation& s) { return s.answers(Answer::no_evidence) && !s.finding.better_description.empty(); },
     [](const Situation& s) {
       const std::string& simpler = s.finding.better_description;
       return use_simpler(
           s, simpler,
           simpler == s.finding.best_competitor ? "" : ", which is about as good as " + s.finding.best_competitor);
     }},
    {[](const Situation& s) { return errors_follow_a_pattern(s.bank) && s.setting("window.model") == "auto"; },
     left_pattern},
    {[](const Situation& s) { return errors_follow_a_pattern(s.bank); },
     [](const Situation&) -> std::string {
       return "errors follow a pattern: `modebank check CONFIG` looks for late stamps";
     }},
    {[](const Situation& s) { return is_uncertain_wrongly(s) && s.setting("filter.noise") != "adaptive"; },
     [](const Situation&) -> std::string {
       return "let the noise follow the run: `modebank run CONFIG --filter.noise adaptive`";
     }},
    {is_uncertain_wrongly,
     [](const Situation&) -> std::string {
       return "train on runs like the held-out ones: `modebank check CONFIG` compares runs, and --data.train names "
              "them";
     }},
    {[](const Situation& s) {
       return s.bank.verdict == Calibration::undecided && reason_of(s.bank) != CalibrationReason::close;
     },
     [](const Situation&) -> std::string {
       return "record more held-out samples, for these are too few to judge the band, and repeat: `modebank run "
              "CONFIG`";
     }},
    {has_few_agreeing_restarts,
     [](const Situation&) {
       return fmt::format("look for a better mixture: `modebank run CONFIG --mixture.restarts {}`", many_restarts);
     }},
    {[](const Situation& s) {
       return s.setting("bank.measurement_variance").empty() &&
              (warns(s, WarningKind::stalled) || warns(s, WarningKind::iteration_limit));
     },
     [](const Situation&) -> std::string {
       return "state the sensor's noise variance by its data sheet: `modebank run CONFIG --bank.measurement_variance "
              "VARIANCE`";
     }},
    {[](const Situation& s) { return warns(s, WarningKind::no_stable_mode); },
     [](const Situation&) -> std::string {
       return "leave the state out that drifts or rests, for no mode is stable with it: `modebank run CONFIG "
              "--data.state STATES`";
     }},
    {[](const Situation& s) { return warns(s, WarningKind::unscored); },
     [](const Situation&) -> std::string {
       return "score more of the samples: `modebank check CONFIG` shows which are missing; fewer --window.state_lags "
              "lose fewer";
     }},
    {[](const Situation& s) { return warns(s, WarningKind::mixture); },
     [](const Situation&) -> std::string {
       return "widen --mixture.components: `modebank show ARCHIVE` prints the warning about it";
     }},
    {[](const Situation&) { return true; },
     [](const Situation&) -> std::string { return "ready: `modebank track ARCHIVE` filters samples as they come"; }},
};

}  // namespace

std::string next_step(const Archive& archive, const Settings& settings) {
  const DiagnosticsRow* const row = diagnosis(archive, "bank", judged_role(archive));
  if (!archive.finding || !row) return "";
  const Situation situation{archive, settings, *archive.finding, *row, archive_warnings(archive)};
  return std::find_if(std::begin(rules), std::end(rules), [&](const Rule& rule) { return rule.applies(situation); })
      ->advice(situation);
}

}  // namespace modebank::app
