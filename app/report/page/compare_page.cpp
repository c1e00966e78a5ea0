#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/report/page/assets.hpp"
#include "app/report/page/numbers.hpp"
#include "app/report/page/paired_runs.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/report/page/write_page.hpp"
#include "app/text/judged_runs.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

/// Keys whose values differ between the runs, in the order of the option table. A value is empty if the version of a
/// run does not have the key.
json configuration_differences(const Archive& first, const Archive& other) {
  const std::map<std::string, std::string> one = resolved_values(first.config), two = resolved_values(other.config);
  json differences = json::array();
  for (const Option& option : option_table()) {
    const auto value = [&](const auto& of) {
      const auto found = of.find(option.key);
      return found == of.end() ? std::string() : found->second;
    };
    if (value(one) != value(two))
      differences.push_back(
          {{"key", option.key}, {"values", {value(one), value(two)}}, {"decides", option.stage.has_value()}});
  }
  return differences;
}

/// A score of the summary. `column` determines whether the larger or the smaller value is better (goal_of).
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

json score_row(const ComparedScore& score, const SummaryRow& first, const SummaryRow& other) {
  const ScoreGoal goal = goal_of(score.column, 1).value();
  const auto cell = [&](double value) { return score.share ? percent(value) : number(value); };
  const double a = score.of(first), b = score.of(other);
  return {{"filter", first.filter},    {"role", name_of(first.role)},
          {"score", score.name},       {"values", {cell(a), cell(b)}},
          {"difference", cell(b - a)}, {"better", a == b ? json() : json(goal.loss(b) < goal.loss(a) ? 1 : 0)}};
}

json scores_of(const Archive& first, const Archive& other) {
  json list = json::array();
  std::vector<std::string> filters{"bank"};
  filters.insert(filters.end(), competitor_names.begin(), competitor_names.end());
  for (const Role role : {Role::test, Role::train})
    for (const std::string& filter : filters) {
      const SummaryRow *a = pooled_row(first, filter, role), *b = pooled_row(other, filter, role);
      if (!a || !b) continue;
      for (const ComparedScore& score : compared_scores) list.push_back(score_row(score, *a, *b));
    }
  return list;
}

/// A sentence that states by how much one run is better than the other.
std::string gain_sentence(const PairedGain& gain) {
  if (gain.gain == 0.0) return "the banks of A and B predict equally well.";
  const char *const ahead = gain.gain > 0 ? "B" : "A", *const behind = gain.gain > 0 ? "A" : "B";
  const std::string size =
      fmt::format("{}{}", gain_words(gain), gain.by_blocks ? " (error from stretches of runs)" : "");
  if (!std::isfinite(gain.margin))
    return fmt::format("the bank of {} scores higher than that of {}{}; there are too few samples to know the error.",
                       ahead, behind, size);
  if (gain.exceeds() || gain.falls_short())
    return fmt::format("the bank of {} predicts better than that of {},{}.", ahead, behind, size);
  return fmt::format(
      "the data cannot tell whether A or B predicts better: {} is ahead{}, which does not exceed the {:.3f} that "
      "chance can explain.",
      ahead, size, gain.margin);
}

/// Whether the bank of the other run predicts better than the bank of the first run, with the reason.
json verdict_of(const Archive& first, const Archive& other) {
  const ArchiveGain found = gain_between(other, first);
  json verdict = {{"runs", found.runs}, {"told", found.gain.exceeds() || found.gain.falls_short()}};
  if (found.runs == 0)
    verdict["text"] = fmt::format("A and B cannot be compared: {}.", found.difference);
  else
    verdict["text"] = fmt::format("On {} {} run{} that both have, {}", found.runs, words_for(judged_role(first)),
                                  found.runs == 1 ? "" : "s", gain_sentence(found.gain));
  return verdict;
}

json run_json(const Archive& archive, const std::string& name) {
  return {{"name", name}, {"origin", origin_section(archive)}, {"bank", bank_section(archive)}};
}

Page compare_page(const Archive& first, const Archive& other, const std::string& name, const std::string& other_name) {
  Page page;
  page.title = fmt::format("{} and {} · modebank", name, other_name);
  page.script = assets::compare_js();
  page.data = {{"kind", "compare"},
               {"verdict", verdict_of(first, other)},
               {"same_data", first.provenance.data_hash == other.provenance.data_hash},
               {"differences", configuration_differences(first, other)},
               {"scores", scores_of(first, other)},
               {"runs", {run_json(first, name), run_json(other, other_name)}}};
  return page;
}

}  // namespace

void report_comparison(const std::filesystem::path& file, const std::filesystem::path& other,
                       const std::filesystem::path& page, Written& written) {
  check_page_path(page, {file, other});
  // If both file names are equal, the names are whole paths.
  const bool same = file.filename() == other.filename();
  const auto name = [same](const std::filesystem::path& path) { return (same ? path : path.filename()).string(); };
  write_page(page,
             compare_page(read_archive(file, Evaluations::in_file), read_archive(other, Evaluations::in_file),
                          name(file), name(other)),
             written);
}

}  // namespace modebank::app::report
