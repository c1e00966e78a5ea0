#include "app/text/next_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "app/chain/judged_runs.hpp"
#include "app/chain/options.hpp"
#include "app/text/warnings.hpp"
#include "io/import/split.hpp"

namespace modebank::app {
namespace {

struct Situation {
  const Archive& archive;
  const Settings& settings;
  const Finding& finding;
  const DiagnosticsRow& bank;  ///< the whole filter on the judged runs

  std::string setting(const std::string& key) const {
    const auto found = settings.find(key);
    return found == settings.end() ? std::string() : found->second;
  }
  bool says(Answer answer) const { return finding.answer == answer; }
};

struct Rule {
  bool (*applies)(const Situation&);
  std::string (*advice)(const Situation&);
};

bool is_lost(const Situation& s) {
  WindowCounts counts;
  if (s.archive.windows) counts.add(*s.archive.windows);
  return counts.of(FitStatus::failed) > 0;
}

int state_lags(const Situation& s) { return std::atoi(s.setting("window.state_lags").c_str()); }

/// What is dropped between blocks of a run.
Index window_and_lags(const Situation& s) {
  const Index lags = s.setting("window.state_lags") == "auto" ? most_automatic_lags : state_lags(s);
  return std::atoi(s.setting("window.length").c_str()) + lags;
}

/// Beyond a few it is not lags that a model lacks.
bool may_have_more_lags(const Situation& s) {
  constexpr int most_lags = 5;
  const std::string model = s.setting("window.model");
  return (model == "linear" || model == "varx") && s.setting("window.state_lags") != "auto" &&
         state_lags(s) < most_lags;
}

bool is_not_white(const Situation& s) { return s.bank.flags.find("innovations not white") != std::string::npos; }

bool is_uncertain_wrongly(const Situation& s) {
  return s.bank.verdict == Verdict::overconfident || s.bank.verdict == Verdict::underconfident;
}

bool has_few_agreeing_restarts(const Situation& s) {
  if (!s.archive.mixture) return false;
  const auto& all = s.archive.mixture->candidates;
  return std::any_of(all.begin(), all.end(),
                     [](const Candidate& c) { return c.selected && 2 * c.agreeing_restarts < c.restarts; });
}

/// From what spoils every number to what only could be better. docs/howto/troubleshooting.md has the same list.
const Rule rules[] = {
    {is_lost,
     [](const Situation&) -> std::string {
       return "some windows have no finite fit: `modebank check CONFIG` says which samples are wild";
     }},
    {[](const Situation& s) { return s.says(Answer::not_yet); },
     [](const Situation&) -> std::string {
       return "bring the samples to an even rate: repeat with --data.rate_hz; `modebank check CONFIG` shows the steps";
     }},
    {[](const Situation& s) { return s.says(Answer::not_comparable); },
     [](const Situation&) -> std::string {
       return "measure more finely, or go by the RMSE: `modebank check CONFIG` says what repeats or comes in steps, "
              "and "
              "which data.rate_hz leaves it out; of rounded values --data.quantum auto compares the intervals";
     }},
    {[](const Situation& s) { return !s.finding.held_out(); },
     [](const Situation& s) -> std::string {
       if (s.archive.recording && s.archive.recording->runs.size() == 1)
         return fmt::format("hold a part of the run out, for only that can be evidence: repeat with --data.split '{}'",
                            proposed_split(s.archive.recording->runs.front().samples(), window_and_lags(s)));
       return "hold runs out, for only they can be evidence: record another, or name some with --data.test";
     }},
    {[](const Situation& s) { return s.says(Answer::cannot_tell); },
     [](const Situation& s) {
       return fmt::format("more held-out runs than {}: record some, or name more of them with --data.test",
                          s.finding.runs);
     }},
    {[](const Situation& s) { return is_not_white(s) && may_have_more_lags(s); },
     [](const Situation& s) {
       const bool acted_on = !s.archive.recording || !s.archive.recording->inputs.empty();
       const std::string lags = state_lags(s) >= most_automatic_lags ? fmt::to_string(state_lags(s) + 1)
                                : acted_on                           ? "auto --window.input_lags auto"
                                                                     : "auto";
       return fmt::format(
           "errors follow a pattern, so the model lacks memory: repeat with --window.model varx --window.state_lags "
           "{}{}",
           lags, s.setting("data.lag_s") == "auto" ? "" : ", or with --data.lag_s auto");
     }},
    {[](const Situation& s) { return s.says(Answer::no_evidence) && !s.finding.better_description.empty(); },
     [](const Situation& s) {
       const std::string& simpler = s.finding.better_description;
       return fmt::format(
           "use the simpler {0} ({1}){2}: `modebank track ARCHIVE --track.filter {0}`", simpler,
           description_of(simpler, s.archive.one_motion_drifts()),
           simpler == s.finding.best_competitor ? "" : ", which is not told apart from " + s.finding.best_competitor);
     }},
    {is_not_white,
     [](const Situation&) -> std::string {
       return "errors follow a pattern: `modebank check CONFIG` looks for a lag between inputs and states, and for "
              "what "
              "the model lacks";
     }},
    {[](const Situation& s) { return is_uncertain_wrongly(s) && s.setting("filter.noise") != "adaptive"; },
     [](const Situation&) -> std::string {
       return "let the noise follow the run: repeat with --filter.noise adaptive";
     }},
    {is_uncertain_wrongly,
     [](const Situation&) -> std::string {
       return "train on runs like the held-out ones: `modebank check CONFIG` compares runs, --data.train names them";
     }},
    {[](const Situation& s) { return s.bank.verdict == Verdict::undecided; },
     [](const Situation&) -> std::string {
       return "more held-out samples, to know whether the band is false: record some, or name more with --data.test";
     }},
    {has_few_agreeing_restarts,
     [](const Situation& s) {
       return fmt::format("look for a better mixture: repeat with --mixture.restarts {}",
                          4 * std::max(5, std::atoi(s.setting("mixture.restarts").c_str())));
     }},
    {[](const Situation& s) { return s.archive.measured_fit == MeasuredFit::iteration_limit; },
     [](const Situation& s) {
       return fmt::format("let the fit with measurement noise end: repeat with --bank.max_iterations {}",
                          std::min(1000, 4 * std::max(25, std::atoi(s.setting("bank.max_iterations").c_str()))));
     }},
    {[](const Situation& s) { return !archive_warnings(s.archive).empty(); },
     [](const Situation&) -> std::string {
       return "see to the warning first (`modebank show ARCHIVE` has it where it belongs); what it leaves is ready to "
              "use";
     }},
    {[](const Situation&) { return true; },
     [](const Situation&) -> std::string {
       return "nothing: use it (`modebank track ARCHIVE` filters samples as they come)";
     }},
};

}  // namespace

std::string next_step(const Archive& archive, const Settings& settings) {
  const DiagnosticsRow* const row = diagnosis(archive, "bank", judged_role(archive));
  if (!archive.finding || !row) return "";
  const Situation situation{archive, settings, *archive.finding, *row};
  return std::find_if(std::begin(rules), std::end(rules), [&](const Rule& rule) { return rule.applies(situation); })
      ->advice(situation);
}

}  // namespace modebank::app
