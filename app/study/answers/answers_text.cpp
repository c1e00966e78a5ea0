#include "app/study/answers/answers_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace modebank::app {
namespace {

std::vector<KeyInfluence> ranked_influences(const Answers& answers) {
  std::vector<KeyInfluence> ranked;
  for (const KeyInfluence& influence : answers.influences)
    if (influence.score == answers.headline) ranked.push_back(influence);
  std::stable_sort(ranked.begin(), ranked.end(), [](const KeyInfluence& a, const KeyInfluence& b) {
    return (std::isnan(a.share) ? -1.0 : a.share) > (std::isnan(b.share) ? -1.0 : b.share);
  });
  return ranked;
}

std::string effects_text(const Answers& answers) {
  if (answers.influences.empty()) return "";
  std::string text = fmt::format(
      "Main effects: mean over all trials with a value of the key. share: part of the variance of {} over the "
      "trials\nthat the key explains. sd: standard deviation between those trials\n{:<28} {:>7} {:>10} {:>9}",
      answers.headline, "", "trials", "log_score", "sd");
  for (const KeyInfluence& influence : ranked_influences(answers)) {
    text += "\n" + influence.key +
            (std::isnan(influence.share) ? "" : fmt::format(" (share {:.0f} %)", 100 * influence.share));
    for (const MainEffect& effect : answers.main_effects) {
      if (effect.key != influence.key || effect.score != answers.headline) continue;
      text += fmt::format("\n  {:<26} {:>7} {:>10.4f} {:>9.4f}", effect.value.empty() ? "''" : effect.value,
                          effect.trials, effect.mean, effect.sd);
    }
  }
  return text + "\n";
}

std::string best_text(const StudyTable& table, const Answers& answers) {
  const std::string prefix = answers.headline.substr(0, answers.headline.rfind("log_score"));
  std::string text = fmt::format("\nBest per score (over repeats: by their mean)\n{:<28} {:<14} {:>10}  {:<12}  {}\n",
                                 "score", "better", "value", "trial", "setting");
  for (const BestSetting& best : answers.best)
    if (best.score.rfind(prefix, 0) == 0)
      text += fmt::format("{:<28} {:<14} {:>10.5g}  {:<12}  {}\n", best.score, best.goal.text(), best.value,
                          table.rows[best.row].key.substr(0, 12), setting_text(table, best.row));
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
  return effects_text(answers) + best_text(table, answers);
}

}  // namespace modebank::app
