#include "app/study/answers/answers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace modebank::app {
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// For each setting, its finished trials as row numbers in the order of the table.
using Settings = std::vector<std::vector<std::size_t>>;

Settings finished_settings(const StudyTable& table) {
  Settings settings;
  std::map<std::vector<std::string>, std::size_t> index;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (table.rows[i].status != TrialStatus::done) continue;
    const auto [found, fresh] = index.emplace(table.rows[i].varied, settings.size());
    if (fresh) settings.emplace_back();
    settings[found->second].push_back(i);
  }
  return settings;
}

std::vector<double> values_of(const StudyTable& table, const std::vector<std::size_t>& rows, std::size_t score) {
  std::vector<double> values;
  for (const std::size_t row : rows)
    if (std::isfinite(table.rows[row].scores.at(score))) values.push_back(table.rows[row].scores[score]);
  return values;
}

double mean_of(const std::vector<double>& values) {
  return values.empty() ? no_number
                        : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double squares_about(const std::vector<double>& values, double centre) {
  double sum = 0.0;
  for (const double value : values) sum += (value - centre) * (value - centre);
  return sum;
}

double variance_of(const std::vector<double>& values) {
  return values.size() < 2 ? no_number
                           : squares_about(values, mean_of(values)) / static_cast<double>(values.size() - 1);
}

std::optional<std::size_t> column_of(const StudyTable& table, const std::string& score) {
  const auto found = std::find(table.score_names.begin(), table.score_names.end(), score);
  if (found == table.score_names.end()) return {};
  return static_cast<std::size_t>(found - table.score_names.begin());
}

int state_count(const StudyTable& table, const std::string& score) {
  const std::string prefix = score.substr(0, score.find("nis_mean")) + "rmse";
  return static_cast<int>(std::max<std::ptrdiff_t>(
      1, std::count_if(table.score_names.begin(), table.score_names.end(),
                       [&prefix](const std::string& name) { return name.rfind(prefix, 0) == 0; })));
}

std::optional<ScoreGoal> goal_in(const StudyTable& table, std::size_t score) {
  return goal_of(table.score_names[score], state_count(table, table.score_names[score]));
}

/// The best mean over the repeats of a setting; NaN if there are no scores.
double best_mean(const StudyTable& table, const std::vector<std::size_t>& rows, std::size_t score,
                 const ScoreGoal& goal) {
  std::map<std::vector<std::string>, std::vector<std::size_t>> settings;
  for (const std::size_t row : rows) settings[table.rows[row].varied].push_back(row);
  double best = no_number;
  for (const auto& [varied, repeats] : settings) {
    const double mean = mean_of(values_of(table, repeats, score));
    if (!std::isnan(mean) && !(goal.loss(mean) >= goal.loss(best))) best = mean;
  }
  return best;
}

/// The finished trials with one value of a varied key.
struct ValueGroup {
  std::string value;
  std::vector<std::size_t> rows;
};

/// Groups in the order of the plan. None if their means would say nothing about the key: it has too many values, or
/// most of its values have a single setting, although other keys vary.
std::vector<ValueGroup> value_groups(const StudyTable& table, std::size_t key) {
  constexpr std::size_t most_values = 30, few_values = 5;
  std::vector<ValueGroup> groups;
  std::map<std::string, std::size_t> index;
  std::set<std::vector<std::string>> settings;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (table.rows[i].status != TrialStatus::done) continue;
    const std::string& value = table.rows[i].varied.at(key);
    const auto [found, fresh] = index.emplace(value, groups.size());
    if (fresh) groups.push_back({value, {}});
    groups[found->second].rows.push_back(i);
    settings.insert(table.rows[i].varied);
  }
  const bool thin = table.varied_keys.size() > 1 && groups.size() > few_values && settings.size() < 2 * groups.size();
  return thin || groups.size() > most_values ? std::vector<ValueGroup>() : groups;
}

/// Adds the effects of one key on one score.
void add_effects(const StudyTable& table, const std::string& key, const std::vector<ValueGroup>& groups,
                 std::size_t score, Answers& answers) {
  const std::string& name = table.score_names[score];
  const ScoreGoal goal = goal_in(table, score).value();
  std::vector<double> all;
  double within = 0.0;
  for (const ValueGroup& group : groups) {
    const std::vector<double> values = values_of(table, group.rows, score);
    const double mean = mean_of(values);
    answers.main_effects.push_back({key, group.value, name, static_cast<int>(values.size()), mean,
                                    std::sqrt(variance_of(values)), best_mean(table, group.rows, score, goal)});
    within += squares_about(values, mean);
    all.insert(all.end(), values.begin(), values.end());
  }
  const double total = squares_about(all, mean_of(all));
  answers.influences.push_back({key, name, total > 0.0 ? 1.0 - within / total : no_number});
}

std::optional<BestSetting> best_setting(const StudyTable& table, const Settings& settings, std::size_t score,
                                        const ScoreGoal& goal) {
  std::optional<BestSetting> best;
  for (const auto& rows : settings) {
    const std::vector<double> values = values_of(table, rows, score);
    if (values.empty()) continue;
    const double mean = mean_of(values);
    if (!best || goal.loss(mean) < goal.loss(best->value))
      best = {table.score_names[score], goal, mean, static_cast<int>(values.size()), rows.front()};
  }
  return best;
}

std::string headline_of(const StudyTable& table) {
  for (const char* name : {"bank_test_log_score", "bank_train_log_score"})
    if (const auto column = column_of(table, name))
      for (const TrialRow& row : table.rows)
        if (row.status == TrialStatus::done && std::isfinite(row.scores.at(*column))) return name;
  return "";
}

}  // namespace

Answers answer(const StudyTable& table) {
  Answers answers;
  answers.headline = headline_of(table);
  const Settings settings = finished_settings(table);
  for (std::size_t key = 0; key < table.varied_keys.size(); ++key) {
    const std::vector<ValueGroup> groups = value_groups(table, key);
    for (std::size_t score = 0; score < table.score_names.size(); ++score)
      if (!groups.empty() && goal_in(table, score)) add_effects(table, table.varied_keys[key], groups, score, answers);
  }
  for (std::size_t score = 0; score < table.score_names.size(); ++score) {
    const std::optional<ScoreGoal> goal = goal_in(table, score);
    if (!goal) continue;
    if (const auto best = best_setting(table, settings, score, *goal)) answers.best.push_back(*best);
  }
  return answers;
}

}  // namespace modebank::app
