#include <algorithm>
#include <cmath>
#include <limits>

#include "app/report/page/assets.hpp"
#include "app/report/page/study_page.hpp"
#include "app/study/answers/answers.hpp"
#include "app/study/answers/value_groups.hpp"
#include "filter/judge/decide/finding.hpp"
#include "filter/step/combined_filter.hpp"

namespace modebank::app::report {
namespace {

constexpr const char* components_key = "mixture.components";
constexpr double percent_of_share = 100.0;
constexpr std::size_t most_panels = 8;

template <class Row>
Eigen::MatrixXd in_rows(const std::vector<Row>& list) {
  Eigen::MatrixXd rows(std::ssize(list), Row::RowsAtCompileTime);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) rows.row(i) = list[static_cast<std::size_t>(i)].transpose();
  return rows;
}

/// Mean over the runs with that value; NaN without any. An empty value: the first there is.
double effect(const Answers& answers, const std::string& value, const std::string& score) {
  for (const MainEffect& effect : answers.main_effects)
    if (effect.key == components_key && effect.score == score && (value.empty() || effect.value == value))
      return percent_of_share * effect.mean;
  return std::numeric_limits<double>::quiet_NaN();
}

/// Values of the number of components in the order of the plan.
std::vector<std::string> component_counts(const Answers& answers) {
  std::vector<std::string> counts;
  for (const MainEffect& effect : answers.main_effects)
    if (effect.key == components_key && std::find(counts.begin(), counts.end(), effect.value) == counts.end())
      counts.push_back(effect.value);
  return counts;
}

/// Column of the headline score.
std::size_t headline_column(const StudyTable& table, const Answers& answers) {
  return static_cast<std::size_t>(std::find(table.score_names.begin(), table.score_names.end(), answers.headline) -
                                  table.score_names.begin());
}

/// The competitors that trials scored, and all filters combined.
std::vector<std::string> other_filters(const Answers& answers) {
  std::vector<std::string> filters(competitor_names.begin(), competitor_names.end());
  filters.emplace_back(combined_name);
  std::erase_if(
      filters, [&](const std::string& filter) { return std::isnan(effect(answers, "", filter + "_train_nis_above")); });
  return filters;
}

/// Samples outside the interval over K: the paper's figure 5.
void add_coverage(const Answers& answers, FigureSet& set) {
  const std::vector<std::string> counts = component_counts(answers);
  if (counts.empty()) {
    set.left_out.emplace_back("coverage over K: the study does not vary mixture.components, or no run has finished");
    return;
  }
  struct Bar {
    std::string title, filter, value;
  };
  std::vector<Bar> bars;
  for (const std::string& filter : other_filters(answers)) {
    bars.push_back({filter, filter, ""});
    std::replace(bars.back().title.begin(), bars.back().title.end(), '_', ' ');
  }
  for (const std::string& count : counts) bars.push_back({"K = " + count, "bank", count});
  Figure figure("coverage", assets::figure_coverage());
  std::vector<std::string> titles;
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(bars.size()), 5);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Bar& bar = bars[static_cast<std::size_t>(i)];
    titles.push_back(bar.title);
    const auto share = [&](const char* score) { return effect(answers, bar.value, bar.filter + score); };
    rows.row(i) << static_cast<double>(i + 1), share("_train_nis_above"), share("_train_nis_below"),
        share("_test_nis_above"), share("_test_nis_below");
  }
  figure.set("filters", rows.rows());
  figure.set("filter_title", titles);
  figure.add_block("NIS outside its 95 % interval [%], mean over the runs with that K",
                   {"position", "train above", "train below", "test above", "test below"}, rows);
  figure.set_caption(
      "Share of samples whose normalised innovation squared (NIS) lies above (upwards) or below (downwards) its 95 % "
      "interval, mean over the study's runs with K mixture components; 2.5 % on either side is true.");
  set.figures.push_back(std::move(figure));
}

/// Where the better part of the scores lies: from half as far below the worst of the values' bests as the best lies
/// above it. Runs further below are not drawn.
void set_score_range(const std::vector<double>& bests, Figure& figure) {
  const auto [low, high] = std::minmax_element(bests.begin(), bests.end());
  const double range = *high > *low ? *high - *low : std::max(0.1, 0.1 * std::abs(*high));
  figure.set("lowest", *low - 0.5 * range);
  figure.set("highest", *high + 0.1 * range);
}

std::string score_title(const Answers& answers) {
  return answers.headline == "bank_test_log_score" ? "held-out log score [nats]" : "training log score [nats]";
}

/// One word for gnuplot's list of words: the value as a number where it is long.
std::string level_word(std::string value) {
  std::replace(value.begin(), value.end(), ' ', '_');
  if (value.empty()) return "-";
  constexpr std::size_t longest = 10;
  return value.size() > longest ? value.substr(0, longest - 2) + ".." : value;
}

/// The best that each value of each key can reach.
void add_effects(const StudyTable& table, const Answers& answers, FigureSet& set) {
  const std::size_t score = headline_column(table, answers);
  Figure figure("effects", assets::figure_effects());
  std::vector<std::string> keys, counts, titles;
  std::vector<double> bests;
  for (std::size_t key = 0; key < table.varied_keys.size() && keys.size() < most_panels; ++key) {
    const std::vector<ValueGroup> groups = value_groups(table, key);
    if (groups.size() < 2 || score == table.score_names.size()) continue;
    std::vector<Eigen::Vector3d> levels;
    std::vector<Eigen::Vector2d> runs;
    std::string words;
    for (const ValueGroup& group : groups) {
      for (const MainEffect& effect : answers.main_effects)
        if (effect.key == table.varied_keys[key] && effect.score == answers.headline && effect.value == group.label) {
          levels.emplace_back(static_cast<double>(levels.size() + 1), effect.best, effect.mean);
          bests.push_back(effect.best);
        }
      words += (words.empty() ? "" : " ") + level_word(group.label);
      for (const std::size_t row : group.rows)
        runs.emplace_back(static_cast<double>(levels.size()), table.rows[row].scores[score]);
    }
    keys.push_back(table.varied_keys[key]);
    counts.push_back(std::to_string(levels.size()));
    titles.push_back(words);
    figure.add_block(keys.back(), {"position", "best", "mean"}, in_rows(levels));
    figure.add_block("its runs", {"position", "score"}, in_rows(runs));
  }
  if (keys.empty()) {
    set.left_out.emplace_back("effects: no key has two values with finished runs");
    return;
  }
  figure.set("panels", std::ssize(keys));
  figure.set("key_title", keys);
  figure.set("level_count", counts);
  figure.set("level_titles", titles);
  figure.set("score_title", score_title(answers));
  set_score_range(bests, figure);
  figure.set_caption(
      "What the varied settings do to the log score: the best that each value reaches over all other settings, and the "
      "mean of its runs. Runs far below are outside the frame.");
  set.figures.push_back(std::move(figure));
}

/// Score against number of modes.
void add_pareto(const StudyTable& table, const Answers& answers, FigureSet& set) {
  if (answers.pareto.empty()) {
    set.left_out.emplace_back("pareto: no run has finished with a number of modes and a log score");
    return;
  }
  const std::size_t score = headline_column(table, answers);
  std::vector<Eigen::Vector2d> runs, front;
  std::vector<double> bests;
  double most_modes = 1.0;
  for (const TrialRow& row : table.rows) {
    if (row.status != TrialStatus::done) continue;
    runs.emplace_back(row.scores[0], row.scores[score]);
    most_modes = std::max(most_modes, row.scores[0]);
  }
  for (const ParetoSetting& setting : answers.pareto) {
    front.emplace_back(setting.modes, setting.log_score);
    bests.push_back(setting.log_score);
  }
  Figure figure("pareto", assets::figure_pareto());
  figure.set("most_modes", most_modes);
  figure.set("score_title", score_title(answers));
  set_score_range(bests, figure);
  figure.add_block("runs", {"modes", "score"}, in_rows(runs));
  figure.add_block("front", {"modes", "score"}, in_rows(front));
  figure.set_caption(
      "Log score of the study's runs over their number of modes, and the settings (means over repeats) that "
      "no other beats with as few modes. Runs far below are outside the frame.");
  set.figures.push_back(std::move(figure));
}

}  // namespace

FigureSet study_figures(const StudyTable& table) {
  FigureSet set;
  const Answers answers = answer(table);
  add_coverage(answers, set);
  add_effects(table, answers, set);
  add_pareto(table, answers, set);
  return set;
}

}  // namespace modebank::app::report
