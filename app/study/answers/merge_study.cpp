#include "app/study/answers/merge_study.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "app/config/option_text.hpp"
#include "io/files/csv_field.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Sets the status of one planned row and returns the row's scores with their names.
std::optional<TrialScores> settle(const TrialStore& store, const std::set<std::string>& whole, TrialRow& row) {
  row.status = TrialStatus::missing;
  row.message.clear();
  if (store.has_archive(row.key)) {
    const std::vector<std::string> problems =
        whole.count(row.key) ? std::vector<std::string>() : store.problems(row.key);
    if (problems.empty()) {
      row.status = TrialStatus::done;
      return read_trial_scores(store.archive(row.key));
    }
    row.message = problems.front();
  }
  if (const auto failure = store.failure(row.key)) {
    row.status = TrialStatus::failed;
    row.message = *failure;
  }
  return std::nullopt;
}

/// The names of all scores, in the order in which they first appear.
std::vector<std::string> score_names(const std::vector<std::optional<TrialScores>>& scores) {
  std::vector<std::string> names{"modes"};
  std::set<std::string> seen;
  for (const auto& trial : scores)
    if (trial)
      for (const auto& [name, value] : trial->pooled)
        if (seen.insert(name).second) names.push_back(name);
  return names;
}

/// The texts as numbers. Empty texts become NaN. Nullopt if one text is not a number or all are empty.
std::optional<std::vector<double>> as_numbers(const std::vector<std::string>& texts) {
  std::vector<double> numbers;
  for (const std::string& text : texts) {
    double value = none;
    try {
      if (!text.empty()) parse_value(text, value);
    } catch (const std::invalid_argument&) {
      return std::nullopt;
    }
    numbers.push_back(value);
  }
  if (std::all_of(texts.begin(), texts.end(), [](const std::string& text) { return text.empty(); }))
    return std::nullopt;
  return numbers;
}

template <class T, class Member>
NamedColumn column_of(const std::string& name, const std::vector<TrialRow>& rows, Member member) {
  std::vector<T> values;
  for (const TrialRow& row : rows) values.push_back(member(row));
  return {name, std::move(values)};
}

std::string cell(const NamedColumn& column, std::size_t row) {
  return std::visit(
      [&](const auto& values) -> std::string {
        using T = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (std::is_same_v<T, std::string>)
          return csv_field(values[row]);
        else if constexpr (std::is_same_v<T, double>)
          return std::isnan(values[row]) ? "" : fmt::format("{}", values[row]);
        else
          return fmt::format("{}", values[row]);
      },
      column.values);
}

}  // namespace

StudyTable collect_table(const TrialStore& store, const StudyPlan& plan, const std::set<std::string>& whole) {
  StudyTable table = plan.table;
  std::vector<std::optional<TrialScores>> scores(table.rows.size());
  tbb::parallel_for(std::size_t{0}, table.rows.size(), [&](std::size_t i) {
    if (table.rows[i].status != TrialStatus::dropped) scores[i] = settle(store, whole, table.rows[i]);
  });
  return with_scores(std::move(table), scores);
}

StudyTable with_scores(StudyTable table, const std::vector<std::optional<TrialScores>>& scores) {
  table.score_names = score_names(scores);
  std::map<std::string, std::size_t> places;
  for (std::size_t s = 0; s < table.score_names.size(); ++s) places[table.score_names[s]] = s;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    std::vector<double>& values = table.rows[i].scores;
    values.assign(table.score_names.size(), none);
    if (!scores[i]) continue;
    values[0] = static_cast<double>(scores[i]->modes);
    table.rows[i].evidence = scores[i]->evidence;
    for (const auto& [name, value] : scores[i]->pooled) values[places[name]] = value;
  }
  return table;
}

std::vector<NamedColumn> table_columns(const StudyTable& table) {
  const std::vector<TrialRow>& rows = table.rows;
  std::vector<NamedColumn> columns;
  for (std::size_t i = 0; i < table.varied_keys.size(); ++i) {
    NamedColumn column =
        column_of<std::string>(table.varied_keys[i], rows, [i](const TrialRow& row) { return row.varied[i]; });
    if (auto numbers = as_numbers(std::get<std::vector<std::string>>(column.values)))
      column.values = std::move(*numbers);
    columns.push_back(std::move(column));
  }
  columns.push_back(column_of<std::int64_t>("repeat", rows, [](const TrialRow& row) { return row.repeat; }));
  columns.push_back(column_of<std::uint64_t>("seed", rows, [](const TrialRow& row) { return row.seed; }));
  columns.push_back(
      column_of<std::string>("status", rows, [](const TrialRow& row) { return std::string(name_of(row.status)); }));
  columns.push_back(column_of<std::string>("message", rows, [](const TrialRow& row) { return row.message; }));
  columns.push_back(column_of<std::string>("evidence", rows, [](const TrialRow& row) { return row.evidence; }));
  columns.push_back(column_of<std::string>("key", rows, [](const TrialRow& row) { return row.key; }));
  for (std::size_t s = 0; s < table.score_names.size(); ++s)
    columns.push_back(
        column_of<double>(table.score_names[s], rows, [s](const TrialRow& row) { return row.scores[s]; }));
  return columns;
}

std::string table_csv(const StudyTable& table) {
  const std::vector<NamedColumn> columns = table_columns(table);
  std::string text;
  for (const NamedColumn& column : columns) text += (text.empty() ? "" : ",") + csv_field(column.name);
  text += "\n";
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    for (std::size_t c = 0; c < columns.size(); ++c) text += (c == 0 ? "" : ",") + cell(columns[c], row);
    text += "\n";
  }
  return text;
}

StudyFile study_file_of(const StudyPlan& plan, const StudyTable& table, const Answers& answers) {
  return {plan.provenance, plan.config, "study", table_columns(table), {}, answer_tables(table, answers)};
}

void write_study(const TrialStore& store, const StudyPlan& plan, const StudyTable& table, const Answers& answers) {
  StudyFile file = study_file_of(plan, table, answers);
  for (const TrialRow& row : table.rows)
    if (row.status == TrialStatus::done) file.archives.emplace_back(row.key, store.archive(row.key));
  write_study_file(store.folder() / "study.h5", file);
  const std::string csv = table_csv(table);
  replace_file(store.folder() / "study.csv", {csv});
  // Only for the plan of this table: another process may have added values to the plan during a long pause.
  const StudyPlan there = read_plan(store.folder());
  if (there.config != plan.config || there.table.rows.size() != plan.table.rows.size()) return;
  StudyPlan current = plan;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    current.table.rows[i].status = table.rows[i].status;
    current.table.rows[i].message = table.rows[i].message;
  }
  write_plan(store.folder(), current);
}

}  // namespace modebank::app
