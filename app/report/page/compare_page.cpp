#include "app/report/page/compare_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/report/page/assets.hpp"
#include "app/report/page/matched_modes.hpp"
#include "app/report/page/numbers.hpp"
#include "app/report/page/paired_runs.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/text/judged_runs.hpp"
#include "app/text/mode_families.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;
using Runs = std::vector<ComparedRun>;

/// Keys whose values differ between the runs, in the order of the option table. A value is empty if the version of a
/// run does not have the key.
json configuration_differences(const Runs& runs) {
  std::vector<std::map<std::string, std::string>> resolved;
  for (const ComparedRun& run : runs) resolved.push_back(resolved_values(run.archive.config));
  json differences = json::array();
  for (const Option& option : option_table()) {
    std::vector<std::string> values;
    for (const auto& of : resolved) {
      const auto found = of.find(option.key);
      values.push_back(found == of.end() ? std::string() : found->second);
    }
    if (std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) != values.end())
      differences.push_back(
          {{"key", option.key}, {"values", values}, {"help", option.help}, {"decides", option.stage.has_value()}});
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

json score_row(const ComparedScore& score, const std::vector<const SummaryRow*>& rows) {
  const ScoreGoal goal = goal_of(score.column, 1).value();
  const auto cell = [&](double value) { return score.share ? percent(value) : number(value); };
  json values = json::array(), differences = json::array();
  std::size_t best = 0;
  bool equal = true;
  const double first = score.of(*rows[0]);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double value = score.of(*rows[k]);
    values.push_back(cell(value));
    if (k > 0) differences.push_back(cell(value - first));
    if (goal.loss(value) < goal.loss(score.of(*rows[best]))) best = k;
    equal = equal && value == first;
  }
  return {{"filter", rows[0]->filter}, {"role", name_of(rows[0]->role)}, {"score", score.name},
          {"values", values},          {"differences", differences},     {"better", equal ? json() : json(best)}};
}

json scores_of(const Runs& runs) {
  json list = json::array();
  std::vector<std::string> filters{"bank"};
  filters.insert(filters.end(), competitor_names.begin(), competitor_names.end());
  for (const Role role : {Role::test, Role::train})
    for (const std::string& filter : filters) {
      std::vector<const SummaryRow*> rows;
      for (const ComparedRun& run : runs)
        if (const SummaryRow* row = pooled_row(run.archive, filter, role)) rows.push_back(row);
      if (rows.size() != runs.size()) continue;
      for (const ComparedScore& score : compared_scores) list.push_back(score_row(score, rows));
    }
  return list;
}

/// A sentence that states by how much one run is better than another.
std::string gain_sentence(const PairedGain& gain, const std::string& first, const std::string& other) {
  if (gain.gain == 0.0) return fmt::format("the banks of {} and {} predict equally well.", first, other);
  const std::string &ahead = gain.gain > 0 ? other : first, &behind = gain.gain > 0 ? first : other;
  const std::string size =
      fmt::format("{}{}", gain_words(gain), gain.by_blocks ? " (error from stretches of runs)" : "");
  if (!std::isfinite(gain.margin))
    return fmt::format("the bank of {} scores higher than that of {}{}; there are too few samples to know the error.",
                       ahead, behind, size);
  if (gain.exceeds() || gain.falls_short())
    return fmt::format("the bank of {} predicts better than that of {},{}.", ahead, behind, size);
  return fmt::format(
      "the data cannot tell whether {} or {} predicts better: {} is ahead{}, which does not exceed the {:.3f} that "
      "chance "
      "can explain.",
      first, other, ahead, size, gain.margin);
}

/// Whether the bank of run k predicts better than the bank of the first run, with the reason.
json calibration_of(const Runs& runs, std::size_t k) {
  const std::string letter(1, static_cast<char>('A' + k));
  const ArchiveGain found = gain_between(runs[k].archive, runs[0].archive);
  json verdict = {{"runs", found.runs},
                  {"gain", estimate(found.gain.gain, found.gain.standard_error)},
                  {"margin", number(found.gain.margin)},
                  {"told", found.gain.exceeds() || found.gain.falls_short()}};
  if (found.runs == 0)
    verdict["text"] = fmt::format("A and {} cannot be compared: {}.", letter, found.difference);
  else
    verdict["text"] =
        fmt::format("On {} {} run{} that both have, {}", found.runs, words_for(judged_role(runs[0].archive)),
                    found.runs == 1 ? "" : "s", gain_sentence(found.gain, "A", letter));
  return verdict;
}

json verdicts_of(const Runs& runs) {
  json verdicts = json::array();
  for (std::size_t k = 1; k < runs.size(); ++k) verdicts.push_back(calibration_of(runs, k));
  return verdicts;
}

json z_cells(const MatchedMode& pair) {
  json cells = json::array();
  for (Index i = 0; i < pair.z.size(); ++i) cells.push_back(number(pair.z(i), fmt::format("{:+.1f}", pair.z(i))));
  return cells;
}

/// Pairs of families from two banks. Each family of the first bank is paired with the family of the other bank that
/// shares most time with it. Families of the other bank that are in no pair follow. Empty if the archives have no run
/// in common.
json families_side_by_side(const Archive& first, const Archive& other) {
  const std::vector<ModeFamily> one = mode_families(first), two = mode_families(other);
  const Eigen::MatrixXd shared = time_in_common(first, other, family_of_modes(one), family_of_modes(two));
  json pairs = json::array();
  const auto add = [&](Index a, Index b) {
    const ModeFamily &of_a = one[static_cast<std::size_t>(a)], &of_b = two[static_cast<std::size_t>(b)];
    const auto used = [](const ModeFamily& family) { return percent(family.use); };
    pairs.push_back({{"first", of_a.title()},
                     {"second", of_b.title()},
                     {"first_use", used(of_a)},
                     {"second_use", used(of_b)},
                     {"lead", {of_a.modes.front(), of_b.modes.front()}},
                     {"shared", percent(shared(a, b))}});
  };
  std::vector<bool> found(two.size(), false);
  for (Index a = 0; a < shared.rows(); ++a) {
    Index b = 0;
    shared.row(a).maxCoeff(&b);
    found[static_cast<std::size_t>(b)] = true;
    add(a, b);
  }
  for (Index b = 0; b < shared.cols(); ++b) {
    if (found[static_cast<std::size_t>(b)]) continue;
    Index a = 0;
    shared.col(b).maxCoeff(&a);
    add(a, b);
  }
  return pairs;
}

/// The modes of run k beside those of the first run.
json match_of(const Runs& runs, std::size_t k) {
  const auto &first = runs[0].archive.bank, &other = runs[k].archive.bank;
  if (!first || !other)
    return {{"difference", "not both have a bank"},
            {"by_time", false},
            {"families", json::array()},
            {"modes", json::array()}};
  const ModeMatch match = match_modes(*first, *other, time_in_common(runs[0].archive, runs[k].archive));
  json modes = json::array();
  for (const MatchedMode& pair : match.modes)
    modes.push_back({{"first", pair.first},
                     {"second", pair.second},
                     {"distance", number(pair.z.size() ? pair.distance : NAN, fmt::format("{:.2g}", pair.distance))},
                     {"shared", percent(pair.shared)},
                     {"agree", pair.agree()},
                     {"z", z_cells(pair)}});
  return {{"difference", match.difference},
          {"by_time", match.by_time},
          {"families", families_side_by_side(runs[0].archive, runs[k].archive)},
          {"modes", modes}};
}

json matches_of(const Runs& runs) {
  json matches = json::array();
  for (std::size_t k = 1; k < runs.size(); ++k) matches.push_back(match_of(runs, k));
  return matches;
}

json run_json(const ComparedRun& run, PageArrays& arrays, std::size_t room) {
  return {{"name", run.name},
          {"origin", origin_section(run.archive)},
          {"windows", windows_section(run.archive, arrays)},
          {"bank", bank_section(run.archive)},
          {"filter", filter_section(run.archive)},
          {"data", affordable_runs_section(run.archive, arrays, room)}};
}

}  // namespace

Page compare_page(const std::vector<ComparedRun>& runs, const ReportConfig& options) {
  constexpr double bytes_per_MB = 1e6,
                   share_of_signals = 0.8;  // the signals of all runs may use this share of the page's size
  const auto room =
      static_cast<std::size_t>(share_of_signals / static_cast<double>(runs.size()) * options.size_mb * bytes_per_MB);
  Page page;
  std::string names;
  json all = json::array();
  bool same_data = true;
  for (const ComparedRun& run : runs) {
    names += (names.empty() ? "" : " and ") + run.name;
    same_data = same_data && run.archive.provenance.data_hash == runs[0].archive.provenance.data_hash;
    all.push_back(run_json(run, page.arrays, room));
  }
  page.title = fmt::format("{} · modebank", names);
  page.script = assets::compare_js();
  page.data = {{"kind", "compare"},
               {"verdicts", verdicts_of(runs)},
               {"same_data", same_data},
               {"differences", configuration_differences(runs)},
               {"scores", scores_of(runs)},
               {"matches", matches_of(runs)},
               {"runs", all}};
  return page;
}

}  // namespace modebank::app::report
