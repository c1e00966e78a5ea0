#include "app/text/structure_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "app/text/number_text.hpp"
#include "app/text/text_table.hpp"

namespace modebank::app {
namespace {

std::string rmse_cell(const StructureScore& score) {
  std::vector<std::string> values;
  for (const double value : score.rmse) values.push_back(fmt::format("{:.3g}", value));
  return fmt::format("{}", fmt::join(values, " "));
}

std::string left_out_words(const FoundStructure& found) {
  return fmt::format("{} left-out training {}", found.parts, found.by_runs ? "runs" : "stretches");
}

/// The noise lags of an ARMAX, and whether it is one of differences; empty for an ARX.
std::string noise_words(const StructureScore& s) {
  if (s.noise_lags == 0 && !s.differences) return "";
  return fmt::format(", {}{}", counted(s.noise_lags, "noise lag"), s.differences ? ", in differences" : "");
}

std::string lag_words(std::ptrdiff_t state_lags, std::ptrdiff_t input_lags, const InputDelays& delay, bool acted_on) {
  std::string words = counted(state_lags, "state lag");
  if (acted_on)
    words += fmt::format(", {}, delay {} sample{}", counted(input_lags, "input lag"), fmt::join(delay.listed(), ", "),
                         delay == 1 ? "" : "s");
  return words;
}

std::string table_text(const FoundStructure& found, bool acted_on, int width) {
  using Column = TextTable::Column;
  std::vector<Column> columns{{"state lags", 10}};
  if (acted_on) columns.insert(columns.end(), {Column{"input lags", 10}, Column{"delay", 5}});
  columns.insert(columns.end(),
                 {Column{"noise lags", 10}, Column{"log score", 10}, Column{"below the best", 18}, Column{"rmse", 10}});
  const auto asked = [&](double StructureScore::*score) {
    return std::any_of(found.scores.begin(), found.scores.end(),
                       [&](const StructureScore& s) { return !std::isnan(s.*score); });
  };
  std::vector<double StructureScore::*> more;
  for (const auto& [score, title] :
       {std::pair{&StructureScore::drifting_score, "drifting"},
        std::pair{&StructureScore::one_motion_score, "one motion"}, std::pair{&StructureScore::modes_score, "modes"}}) {
    if (!asked(score)) continue;
    columns.push_back({title, 10});
    more.push_back(score);
  }
  columns.push_back({"taken by", 8});
  TextTable table(columns, acted_on ? 4 : 2);
  for (const StructureScore& s : found.scores) {
    std::vector<std::string> cells{fmt::format("{}{}", s.state_lags, s.differences ? " of differences" : "")};
    if (acted_on) cells.insert(cells.end(), {fmt::format("{}", s.input_lags), fmt::format("{}", s.input_delay)});
    cells.push_back(s.noise_lags > 0 ? fmt::format("{}", s.noise_lags) : "");
    const bool left_out = !std::isnan(s.log_score);
    cells.push_back(left_out ? fmt::format("{:.4f}", s.log_score) : "");
    cells.push_back(s.loss == 0.0 || !left_out ? "" : fmt::format("{:.4f} +- {:.4f}", s.loss, s.loss_standard_error));
    cells.push_back(left_out ? rmse_cell(s) : "");
    for (const auto score : more) cells.push_back(std::isnan(s.*score) ? "" : fmt::format("{:.4f}", s.*score));
    cells.push_back(taken_by(s));
    table.add(std::move(cells));
  }
  return table.text(width);
}

}  // namespace

const StructureScore* of_linear(const FoundStructure& found) {
  const auto one = std::ranges::find_if(found.scores, &StructureScore::linear);
  return one == found.scores.end() ? nullptr : &*one;
}

std::string taken_by(const StructureScore& s) {
  std::vector<std::string> stages;
  for (const auto& [taken, stage] : {std::pair{s.chosen, "bank"}, std::pair{s.one_motion, "one_motion"},
                                     std::pair{s.linear, "linear"}, std::pair{s.drifting, "drifting"}})
    if (taken) stages.emplace_back(stage);
  return fmt::format("{}", fmt::join(stages, ", "));
}

std::string structure_words(const FoundStructure& found, bool acted_on) {
  return lag_words(found.state_lags, found.input_lags, found.delays_of_modes(), acted_on);
}

std::string structure_sentence(const FoundStructure& found, bool acted_on) {
  std::string text = "the modes take " + structure_words(found, acted_on);
  if (const StructureScore* linear = of_linear(found)) {
    const std::string lags =
        linear->chosen ? "the same"
                       : lag_words(linear->state_lags, linear->input_lags, found.delays_of(*linear), acted_on) +
                             noise_words(*linear);
    text += fmt::format("; a single linear model takes {} (RMSE {} on {})", lags, rmse_cell(*linear),
                        left_out_words(found));
  }
  if (!found.remark.empty()) text += "; " + found.remark;
  return text;
}

std::string structure_text(const FoundStructure& found, bool acted_on, int width) {
  std::string text = fmt::format("structure {}", structure_words(found, acted_on));
  if (!found.scores.empty())
    text += fmt::format(
        ". A single linear model has the fewest lags within one standard error of the best of {} structures, by {} ({} "
        "samples); the other stages choose among few of them by scores of their own on the training runs",
        found.structures, left_out_words(found), found.samples);
  text += "\n";
  if (!found.scores.empty()) text += table_text(found, acted_on, width);
  if (!found.remark.empty()) text += "          " + found.remark + "\n";
  return text;
}

}  // namespace modebank::app
