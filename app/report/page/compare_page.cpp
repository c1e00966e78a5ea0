#include "app/report/page/compare_page.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/chain/judged_runs.hpp"
#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/report/page/assets.hpp"
#include "app/report/page/numbers.hpp"
#include "app/report/page/run_sections.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;
using Pair = std::array<ComparedRun, 2>;

/// Keys whose values differ, in the table's order; a key that one of them does not know has an empty value there.
json configuration_differences(const Pair& runs) {
  const auto first = resolved_values(runs[0].archive.config), second = resolved_values(runs[1].archive.config);
  const auto text = [](const std::map<std::string, std::string>& values, const std::string& key) {
    const auto found = values.find(key);
    return found == values.end() ? std::string() : found->second;
  };
  json differences = json::array();
  for (const Option& option : option_table()) {
    const std::string a = text(first, option.key), b = text(second, option.key);
    if (a != b)
      differences.push_back(
          {{"key", option.key}, {"values", {a, b}}, {"help", option.help}, {"decides", decides_numbers(option.key)}});
  }
  return differences;
}

/// A score of the summary; `column` says which of two is better (goal_of).
struct ComparedScore {
  const char *name, *column;
  double (*of)(const SummaryRow&);
  bool share = false;
};

constexpr ComparedScore compared_scores[] = {
    {"log score [nats/sample]", "log_score", [](const SummaryRow& row) { return row.log_score; }},
    {"RMSE (all states)", "rmse", [](const SummaryRow& row) { return row.rmse.norm(); }},
    {"In the 95 % band", "coverage_95", [](const SummaryRow& row) { return row.coverage_95; }, true},
    {"Too far", "too_far", [](const SummaryRow& row) { return row.too_far; }, true},
    {"Too close", "too_close", [](const SummaryRow& row) { return row.too_close; }, true},
    {"PIT distance", "pit_distance", [](const SummaryRow& row) { return row.pit_distance; }},
};

/// Positive when the second is better.
double advantage(const ComparedScore& score, double first, double second) {
  const ScoreGoal goal = goal_of(score.column, 1).value();
  return goal.loss(first) - goal.loss(second);
}

json score_row(const ComparedScore& score, const SummaryRow& first, const SummaryRow& second) {
  const double a = score.of(first), b = score.of(second), gain = advantage(score, a, b);
  const auto cell = [&](double value) { return score.share ? percent(value) : number(value); };
  return {{"filter", first.filter},    {"role", name_of(first.role)},
          {"score", score.name},       {"values", {cell(a), cell(b)}},
          {"difference", cell(b - a)}, {"better", gain > 0 ? json(1) : gain < 0 ? json(0) : json()}};
}

json scores_of(const Pair& runs) {
  json rows = json::array();
  std::vector<std::string> filters{"bank"};
  filters.insert(filters.end(), competitor_names.begin(), competitor_names.end());
  for (const Role role : {Role::test, Role::train})
    for (const std::string& filter : filters) {
      const SummaryRow* first = pooled_row(runs[0].archive, filter, role);
      const SummaryRow* second = pooled_row(runs[1].archive, filter, role);
      if (!first || !second) continue;
      for (const ComparedScore& score : compared_scores) rows.push_back(score_row(score, *first, *second));
    }
  return rows;
}

/// The finding in one sentence.
std::string sentence(const Pair& runs) {
  const Role role = judged_role(runs[0].archive);
  const SummaryRow* first = pooled_row(runs[0].archive, "bank", role);
  const SummaryRow* second = pooled_row(runs[1].archive, "bank", role);
  if (!first || !second || judged_role(runs[1].archive) != role)
    return "The two were not both scored on the same kind of runs, so neither is the better one.";
  const double gain = second->log_score - first->log_score;
  if (runs[0].archive.provenance.data_hash != runs[1].archive.provenance.data_hash)
    return fmt::format(
        "The two were made from different data, so their scores do not compare ({:+.3f} nats per sample).", gain);
  if (gain == 0.0) return fmt::format("On {} runs both banks predict equally well.", words_for(role));
  return fmt::format("On {} runs the bank of {} predicts better, by {:.3f} nats per sample.", words_for(role),
                     gain > 0 ? "B" : "A", std::abs(gain));
}

json run_json(const ComparedRun& run, PageArrays& arrays, std::size_t room) {
  return {{"name", run.name},
          {"origin", origin_section(run.archive)},
          {"windows", windows_section(run.archive, arrays)},
          {"selection", selection_section(run.archive)},
          {"bank", bank_section(run.archive)},
          {"filter", filter_section(run.archive)},
          {"data", affordable_runs_section(run.archive, arrays, room)}};
}

}  // namespace

Page compare_page(const std::array<ComparedRun, 2>& runs, const ReportConfig& options) {
  constexpr double bytes_per_MB = 1e6, share_of_signals = 0.4;  // of the page, for each of both
  const auto room = static_cast<std::size_t>(share_of_signals * options.size_mb * bytes_per_MB);
  Page page;
  page.title = fmt::format("{} and {} · modebank", runs[0].name, runs[1].name);
  page.script = assets::compare_js();
  json both = json::array();
  for (const ComparedRun& run : runs) both.push_back(run_json(run, page.arrays, room));
  page.data = {{"kind", "compare"},
               {"verdict", sentence(runs)},
               {"same_data", runs[0].archive.provenance.data_hash == runs[1].archive.provenance.data_hash},
               {"differences", configuration_differences(runs)},
               {"scores", scores_of(runs)},
               {"runs", both}};
  return page;
}

}  // namespace modebank::app::report
