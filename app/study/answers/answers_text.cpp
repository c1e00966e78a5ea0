#include "app/study/answers/answers_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

namespace modebank::app {
namespace {

/// Scores in the printed main effects: the headline, then rmse and tails of the same filter and role.
std::vector<std::string> shown_scores(const StudyTable& table, const std::string& headline) {
  const std::string prefix = headline.substr(0, headline.rfind("log_score"));
  std::vector<std::string> shown{headline};
  for (const std::string& name : table.score_names)
    if (name.rfind(prefix + "rmse", 0) == 0 || name == prefix + "coverage_95" || name.rfind(prefix + "too_", 0) == 0)
      shown.push_back(name);
  return shown;
}

std::string heading_of(const std::string& score, const std::string& headline) {
  return score.substr(headline.rfind("log_score"));
}

const MainEffect* effect_of(const Answers& answers, const std::string& key, const std::string& value,
                            const std::string& score) {
  for (const MainEffect& effect : answers.main_effects)
    if (effect.key == key && effect.value == value && effect.score == score) return &effect;
  return nullptr;
}

std::vector<KeyInfluence> ranked_influences(const Answers& answers) {
  std::vector<KeyInfluence> ranked;
  for (const KeyInfluence& influence : answers.influences)
    if (influence.score == answers.headline) ranked.push_back(influence);
  std::stable_sort(ranked.begin(), ranked.end(), [](const KeyInfluence& a, const KeyInfluence& b) {
    return (std::isnan(a.share) ? -1.0 : a.share) > (std::isnan(b.share) ? -1.0 : b.share);
  });
  return ranked;
}

/// The other keys that always change together with this key, and therefore have the same effects.
std::vector<std::string> keys_in_step(const StudyTable& table, std::size_t key) {
  std::vector<std::string> names;
  for (std::size_t other = 0; other < table.varied_keys.size(); ++other) {
    std::map<std::string, std::string> there, back;
    bool same = other != key;
    for (const TrialRow& row : table.rows) {
      if (row.status != TrialStatus::done) continue;
      const std::string &value = row.varied[key], &theirs = row.varied[other];
      same = same && there.try_emplace(value, theirs).first->second == theirs &&
             back.try_emplace(theirs, value).first->second == value;
    }
    if (same && there.size() > 1) names.push_back(table.varied_keys[other]);
  }
  return names;
}

/// The key and the keys that change together with it. Empty if one of these was already printed.
std::string effect_heading(const StudyTable& table, const KeyInfluence& influence, std::set<std::string>& printed) {
  const auto key = std::find(table.varied_keys.begin(), table.varied_keys.end(), influence.key);
  std::string heading = influence.key;
  for (const std::string& name : keys_in_step(table, static_cast<std::size_t>(key - table.varied_keys.begin()))) {
    if (printed.count(name)) return "";
    heading += " with " + name;
  }
  printed.insert(influence.key);
  return heading + (std::isnan(influence.share) ? "" : fmt::format(" (share {:.0f} %)", 100 * influence.share));
}

std::string effects_text(const StudyTable& table, const Answers& answers) {
  if (answers.influences.empty()) return "";
  const std::vector<std::string> scores = shown_scores(table, answers.headline);
  std::string text = fmt::format(
      "Main effects: mean over all trials with a value of the key. share: part of the variance of {} over the "
      "trials\nthat the key explains. sd: standard deviation between those trials\n{:<28} {:>7} {:>10} {:>9}",
      answers.headline, "", "trials", "log_score", "sd");
  for (std::size_t i = 1; i < scores.size(); ++i)
    text += fmt::format(" {:>10}", heading_of(scores[i], answers.headline));
  std::set<std::string> printed;
  for (const KeyInfluence& influence : ranked_influences(answers)) {
    const std::string heading = effect_heading(table, influence, printed);
    if (heading.empty()) continue;
    text += "\n" + heading;
    for (const MainEffect& effect : answers.main_effects) {
      if (effect.key != influence.key || effect.score != answers.headline) continue;
      text += fmt::format("\n  {:<26} {:>7} {:>10.4f} {:>9.4f}", effect.value.empty() ? "''" : effect.value,
                          effect.trials, effect.mean, effect.sd);
      for (std::size_t i = 1; i < scores.size(); ++i) {
        const MainEffect* other = effect_of(answers, effect.key, effect.value, scores[i]);
        text += fmt::format(" {:>10.4g}", other ? other->mean : std::nan(""));
      }
    }
  }
  return text + "\n";
}

/// The setting without the section names of its keys, if the short names are unique.
std::string short_setting(const StudyTable& table, std::size_t row) {
  const auto name_of_key = [](const std::string& key) { return key.substr(key.find('.') + 1); };
  StudyTable shortened{table.varied_keys, {}, {table.rows[row]}};
  for (std::string& key : shortened.varied_keys) {
    const auto same_name = [&](const std::string& other) { return name_of_key(other) == name_of_key(key); };
    if (std::count_if(table.varied_keys.begin(), table.varied_keys.end(), same_name) == 1) key = name_of_key(key);
  }
  return setting_text(shortened, 0);
}

/// Number of trials for each finding on modes of motion.
std::string evidence_text(const StudyTable& table) {
  std::map<std::string, int> answers;
  for (const TrialRow& row : table.rows)
    if (!row.evidence.empty()) ++answers[row.evidence];
  std::string text;
  for (const auto& [answer, count] : answers)
    text += fmt::format("{}{} in {} trials", text.empty() ? "" : ", ", answer, count);
  return text.empty() ? "" : fmt::format("Modes of motion: {}\n", text);
}

std::string best_text(const StudyTable& table, const Answers& answers) {
  const std::string prefix = answers.headline.substr(0, answers.headline.rfind("log_score"));
  std::string text = fmt::format("\nBest per score (over repeats: by their mean)\n{:<28} {:<14} {:>10}  {:<12}  {}\n",
                                 "score", "better", "value", "trial", "setting");
  for (const BestSetting& best : answers.best)
    if (best.score.rfind(prefix, 0) == 0)
      text += fmt::format("{:<28} {:<14} {:>10.5g}  {:<12}  {}\n", best.score, best.goal.text(), best.value,
                          table.rows[best.row].key.substr(0, 12), short_setting(table, best.row));
  return text + evidence_text(table);
}

std::string spread_text(const StudyTable& table, const Answers& answers) {
  if (answers.spread.empty()) return "";
  const std::vector<std::string> shown = shown_scores(table, answers.headline);
  std::string text = fmt::format("\nSpread over repeats (standard deviations)\n{:<28} {:>8} {:>14} {:>10} {:>17}\n",
                                 "score", "settings", "within setting", "largest", "between settings");
  for (const RepeatSpread& spread : answers.spread)
    if (std::find(shown.begin(), shown.end(), spread.score) != shown.end())
      text += fmt::format("{:<28} {:>8} {:>14.4g} {:>10.4g} {:>17.4g}\n", spread.score, spread.settings, spread.sd,
                          spread.largest_sd, spread.between_sd);
  return text;
}

}  // namespace

std::string setting_text(const StudyTable& table, std::size_t row) {
  std::string text;
  for (std::size_t key = 0; key < table.varied_keys.size(); ++key) {
    const std::string& value = table.rows[row].varied.at(key);
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", table.varied_keys[key], value.empty() ? "''" : value);
  }
  return text.empty() ? "as configured" : text;
}

std::string answers_text(const StudyTable& table, const Answers& answers) {
  if (answers.headline.empty()) return "";
  return effects_text(table, answers) + best_text(table, answers) + spread_text(table, answers);
}

}  // namespace modebank::app
