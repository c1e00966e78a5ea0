#include "app/study/answers/study_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/study/answers/answers.hpp"
#include "app/study/answers/merge_study.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

json values_of(const StudyTable& table, const TrialRow& row) {
  json values = json::object();
  for (std::size_t i = 0; i < row.varied.size(); ++i) values[table.varied_keys[i]] = row.varied[i];
  return values;
}

json row_json(const StudyTable& table, const TrialRow& row) {
  json scores = json::object();
  for (std::size_t i = 0; i < row.scores.size(); ++i)
    if (std::isfinite(row.scores[i])) scores[table.score_names[i]] = row.scores[i];
  return {{"key", row.key},
          {"values", values_of(table, row)},
          {"repeat", row.repeat},
          {"seed", row.seed},
          {"status", name_of(row.status)},
          {"message", row.message},
          {"evidence", row.evidence},
          {"scores", scores}};
}

}  // namespace

json study_json(const std::filesystem::path& folder) {
  json result{
      {"folder", folder.string()}, {"runs", json::array()}, {"counts", json::object()}, {"best", json::array()}};
  if (!std::filesystem::exists(plan_file(folder))) return result;
  const StudyTable table = collect_table(TrialStore(folder), read_plan(folder));
  for (const TrialRow& row : table.rows) {
    result["runs"].push_back(row_json(table, row));
    json& count = result["counts"][std::string(name_of(row.status))];
    count = count.is_null() ? 1 : count.get<int>() + 1;
  }
  for (const BestSetting& best : answer(table).best)
    result["best"].push_back({{"score", best.score},
                              {"value", best.value},
                              {"repeats", best.repeats},
                              {"values", values_of(table, table.rows[best.row])}});
  return result;
}

}  // namespace modebank::app
