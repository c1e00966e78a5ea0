#include "app/cli/log/decisions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/cli/check/check_suggestions.hpp"
#include "app/text/structure_text.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank::app {
namespace {

/// A change to try, and its key. If the user sets this key, the change is not tried.
struct Decision {
  const char* key;
  Change change;
  Effort from;  ///< lowest effort at which the change is tried
};
constexpr Decision decisions[]{
    {"data.lag_s", Change::lag, Effort::normal},      {"bank.measurement_variance", Change::noise, Effort::normal},
    {"data.rate_hz", Change::rate, Effort::thorough}, {"window.length", Change::length, Effort::thorough},
    {"window.loss", Change::loss, Effort::thorough},  {"mixture.restarts", Change::restarts, Effort::thorough},
};

SuggestionScope scope_of(Effort effort, const KeyValues& stated) {
  SuggestionScope scope{{}, effort != Effort::thorough};
  for (const Decision& decision : decisions)
    if (effort >= decision.from &&
        std::none_of(stated.begin(), stated.end(), [&](const auto& each) { return each.first == decision.key; }))
      scope.changes.push_back(decision.change);
  return scope;
}

std::string settings_text(const KeyValues& keys) {
  std::vector<std::string> all;
  for (const auto& [key, value] : keys) all.push_back(fmt::format("{} = {}", key, value));
  return fmt::format("{}", fmt::join(all, ", "));
}

std::string record_trial(const Suggestions& suggestions, const Trial& trial, const Config& config,
                         LogConfiguration& configuration) {
  const KeyValues keys = changed_keys(config, trial.from, trial.to);
  if (keys.empty()) return "";
  const std::string why = gain_reason(suggestions, trial), settings = settings_text(keys);
  if (!trial.accepted) configuration.set(keys.front().first, "", fmt::format("not taken: {}: {}", settings, why));
  for (const auto& [key, value] : keys)
    if (trial.accepted) configuration.set(key, value, why);
  return fmt::format("{}{}: {}", settings, trial.accepted ? "" : " is not taken", why);
}

std::string lag_reason(const LagReport& lag) {
  const auto taken = std::find_if(lag.scores.begin(), lag.scores.end(),
                                  [&](const LagScore& score) { return score.correction == lag.correction; });
  if (lag.correction == LagCorrection::none || taken == lag.scores.end())
    return "no lag gains on training runs left out, so inputs keep their times";
  return fmt::format(
      "inputs act {:+.3f} +- {:.3f} s later than stamped: {:+.3f} +- {:.3f} nats per sample on training "
      "runs left out",
      lag.lag.mean, lag.lag.standard_error, taken->gain, taken->gain_standard_error);
}

}  // namespace

Effort effort_of(const std::string& word) {
  for (const Effort effort : {Effort::quick, Effort::thorough})
    if (name_of(effort) == word) return effort;
  return Effort::normal;
}

std::vector<std::string> decide(const Config& config, Effort effort, const KeyValues& stated,
                                LogConfiguration& configuration, const Listener& listener) {
  const SuggestionScope scope = scope_of(effort, stated);
  if (scope.changes.empty()) return {};
  const DataCheck check = check_data({data_options_of(config), config.window.length, config.window.intercept});
  if (!check.unusable.empty()) return {};  // `run` prints the reason
  const ChainOptions options = chain_options(config);
  const Suggestions suggestions =
      suggest(with_found(options, find_structure(options, listener)), check, scope, listener);
  std::vector<std::string> sentences;
  if (!suggestions.unscored.empty())
    sentences.push_back(fmt::format("nothing more, because no setting could be scored: {}", suggestions.unscored));
  for (const Trial& trial : suggestions.trials)
    if (std::string sentence = record_trial(suggestions, trial, config, configuration); !sentence.empty())
      sentences.push_back(std::move(sentence));
  return sentences;
}

void explain_found(const Archive& archive, LogConfiguration& configuration) {
  if (archive.lag) configuration.explain("data.lag_s", lag_reason(*archive.lag));
  if (archive.structure)
    configuration.set("window.model", "auto", structure_sentence(*archive.structure, acted_on(archive)));
}

}  // namespace modebank::app
