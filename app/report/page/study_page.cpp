#include "app/report/page/study_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "app/report/page/assets.hpp"
#include "app/report/page/numbers.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/study/answers/answers.hpp"
#include "app/text/judged_runs.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

bool numeric(const NamedColumn& column) { return std::holds_alternative<std::vector<double>>(column.values); }

const NamedColumn& varied_column(const StudyFile& file, const std::string& key) {
  return *std::find_if(file.columns.begin(), file.columns.end(), [&](const NamedColumn& c) { return c.name == key; });
}

/// Scores that the table shows at first. The other scores appear after a click.
bool shown_at_first(const std::string& score) {
  for (const char* part : {"_test_log_score", "_test_rmse"})
    if (score.find(part) != std::string::npos) return true;
  return score == "modes" || score == "bank_test_coverage_95" || score == "bank_test_too_far";
}

json goal_json(const std::string& score, int states) {
  const std::optional<ScoreGoal> goal = goal_of(score, states);
  if (!goal) return nullptr;
  const char* kind = goal->kind == ScoreGoal::Kind::higher  ? "higher"
                     : goal->kind == ScoreGoal::Kind::lower ? "lower"
                                                            : "nominal";
  return {{"kind", kind}, {"nominal", goal->nominal}, {"text", goal->text()}};
}

/// Number of measured states. Each of them has an RMSE.
int measured_states(const StudyTable& table) {
  const auto count = std::count_if(table.score_names.begin(), table.score_names.end(),
                                   [](const std::string& name) { return name.rfind("bank_train_rmse_", 0) == 0; });
  return std::max(1, static_cast<int>(count));
}

bool has_repeats(const StudyTable& table) {
  return std::any_of(table.rows.begin(), table.rows.end(), [](const TrialRow& row) { return row.repeat > 0; });
}

json columns_of(const StudyTable& table) {
  json columns = json::array();
  for (const std::string& key : table.varied_keys)
    columns.push_back({{"name", key}, {"kind", "varied"}, {"shown", true}});
  for (const char* name : {"status", "evidence"})
    columns.push_back({{"name", name}, {"kind", "about"}, {"text", true}, {"shown", true}});
  for (const char* name : {"repeat", "seed"})
    columns.push_back({{"name", name}, {"kind", "about"}, {"text", true}, {"shown", has_repeats(table)}});
  for (const std::string& score : table.score_names)
    columns.push_back({{"name", score},
                       {"kind", score == "modes" ? "cost" : "score"},
                       {"shown", shown_at_first(score)},
                       {"goal", goal_json(score, measured_states(table))}});
  return columns;
}

/// Cells of row i in the order of columns_of.
json cells_of(const StudyFile& file, const StudyTable& table, std::size_t i) {
  const TrialRow& row = table.rows[i];
  json cells = json::array();
  for (std::size_t k = 0; k < table.varied_keys.size(); ++k) {
    const NamedColumn& column = varied_column(file, table.varied_keys[k]);
    if (numeric(column))
      cells.push_back(number(std::get<std::vector<double>>(column.values)[i], row.varied[k]));
    else
      cells.push_back(row.varied[k]);
  }
  cells.push_back(name_of(row.status));
  cells.push_back(row.evidence);
  cells.push_back(row.repeat);
  cells.push_back(std::to_string(row.seed));
  for (const double score : row.scores) cells.push_back(number(score));
  return cells;
}

json rows_of(const StudyFile& file, const StudyTable& table, const std::vector<TrialPlace>& places) {
  json rows = json::array();
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const TrialRow& row = table.rows[i];
    rows.push_back({{"number", i},
                    {"status", name_of(row.status)},
                    {"message", row.message},
                    {"key", row.key},
                    {"seed", std::to_string(row.seed)},
                    {"varied", row.varied},
                    {"cells", cells_of(file, table, i)},
                    {"page", places[i].page},
                    {"archive", places[i].archive}});
  }
  return rows;
}

/// Distinct values of each varied key, in the order of the runs.
json varied_of(const StudyTable& table) {
  json list = json::array();
  for (std::size_t k = 0; k < table.varied_keys.size(); ++k) {
    std::vector<std::string> seen;
    for (const TrialRow& row : table.rows)
      if (std::find(seen.begin(), seen.end(), row.varied[k]) == seen.end()) seen.push_back(row.varied[k]);
    constexpr std::size_t most = 20;
    std::string values;
    for (std::size_t i = 0; i < std::min(most, seen.size()); ++i) values += (i ? ", " : "") + seen[i];
    if (seen.size() > most) values += fmt::format(", ... ({} values)", seen.size());
    list.push_back({{"key", table.varied_keys[k]}, {"values", values}});
  }
  return list;
}

json counts_of(const StudyTable& table) {
  std::map<TrialStatus, long long> counts;
  for (const TrialRow& row : table.rows) ++counts[row.status];
  json list = json::array();
  for (const auto& [status, number_of] : counts) list.push_back({name_of(status), count_text(number_of)});
  return list;
}

/// A sentence with the result of the study, and the row of the best setting.
json best_of(const StudyTable& table, const Answers& answers) {
  for (const BestSetting& best : answers.best) {
    if (best.score != answers.headline) continue;
    const TrialRow& row = table.rows[best.row];
    std::string setting;
    for (std::size_t k = 0; k < table.varied_keys.size(); ++k)
      setting += (k ? ", " : "") + table.varied_keys[k] + " = " + row.varied[k];
    std::string text = fmt::format("The best log score of the bank on {} runs, {} nats per sample, comes from {}",
                                   words_for(best.score == "bank_test_log_score" ? Role::test : Role::train),
                                   number_text(best.value), setting);
    if (best.repeats > 1) text += fmt::format(" (mean of {} repeats)", best.repeats);
    if (!row.evidence.empty()) text += fmt::format(". Its finding on modes of motion: {}", row.evidence);
    return {{"text", text + "."}, {"row", best.row}};
  }
  return {{"text", "No run has finished with a score, so there is nothing to judge yet."}, {"row", nullptr}};
}

}  // namespace

Page study_page(const StudyFile& file, const StudyTable& table, const std::vector<TrialPlace>& places,
                const std::string& name) {
  Archive origin;
  origin.provenance = file.provenance;
  origin.config = file.config;
  const Answers answers = answer(table);
  Page page;
  page.title = fmt::format("{} · modebank study", name);
  page.script = assets::study_js();
  page.data = {{"kind", "study"},
               {"file", name},
               {"origin", origin_section(origin)},
               {"study",
                {{"columns", columns_of(table)},
                 {"rows", rows_of(file, table, places)},
                 {"varied", varied_of(table)},
                 {"counts", counts_of(table)},
                 {"best", best_of(table, answers)},
                 {"better", better_section(table, places, answers.headline)},
                 {"standard_score", answers.headline}}}};
  return page;
}

}  // namespace modebank::app::report
