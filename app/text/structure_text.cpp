#include "app/text/structure_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/text/text_table.hpp"

namespace modebank::app {
namespace {

std::string counted(std::ptrdiff_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string rmse_cell(const StructureScore& score) {
  std::vector<std::string> values;
  for (const double value : score.rmse) values.push_back(fmt::format("{:.4g}", value));
  return fmt::format("{}", fmt::join(values, " "));
}

std::string left_out_words(const FoundStructure& found) {
  return fmt::format("{} training {} left out", found.parts, found.by_runs ? "runs" : "stretches");
}

std::string feedback_words(const FoundStructure& found) {
  return fmt::format("the inputs answer to the states (t = {:.1f}), so free runs hold for such inputs alone",
                     found.feedback_t);
}

std::string table_text(const FoundStructure& found, bool acted_on, int width) {
  using Column = TextTable::Column;
  std::vector<Column> columns{{"", 1}, {"state lags", 10}};
  if (acted_on) columns.insert(columns.end(), {Column{"input lags", 10}, Column{"delay", 5}});
  columns.insert(columns.end(), {Column{"log score", 10}, Column{"below the best", 18}, Column{"rmse", 10}});
  if (found.by_drifting) columns.push_back({"drifting", 10});
  TextTable table(columns, acted_on ? 4 : 2);
  for (const StructureScore& s : found.scores) {
    std::vector<std::string> cells{s.chosen ? "*" : "", fmt::format("{}", s.state_lags)};
    if (acted_on) cells.insert(cells.end(), {fmt::format("{}", s.input_lags), fmt::format("{}", s.input_delay)});
    const bool left_out = !std::isnan(s.log_score);
    cells.push_back(left_out ? fmt::format("{:.4f}", s.log_score) : "");
    cells.push_back(s.loss == 0.0 || !left_out ? "" : fmt::format("{:.4f} +- {:.4f}", s.loss, s.loss_standard_error));
    cells.push_back(left_out ? rmse_cell(s) : "");
    if (found.by_drifting) cells.push_back(fmt::format("{:.4f}", s.drifting_score));
    table.add(std::move(cells));
  }
  return table.text(width);
}

}  // namespace

std::string structure_words(const FoundStructure& found, bool acted_on) {
  std::string words = counted(found.state_lags, "state lag");
  if (acted_on)
    words +=
        fmt::format(", {}, delay {}", counted(found.input_lags, "input lag"), counted(found.input_delay, "sample"));
  return words;
}

std::string structure_sentence(const FoundStructure& found, bool acted_on) {
  std::string text = structure_words(found, acted_on);
  const auto chosen =
      std::find_if(found.scores.begin(), found.scores.end(), [](const StructureScore& s) { return s.chosen; });
  if (found.by_drifting)
    text +=
        ": chosen by the training runs' forecasts with wandering coefficients, which are better than with constant "
        "ones";
  else if (chosen != found.scores.end())
    text +=
        fmt::format(": log score {:.3f}, RMSE {} on {}", chosen->log_score, rmse_cell(*chosen), left_out_words(found));
  if (found.feedback()) text += "; " + feedback_words(found);
  if (!found.remark.empty()) text += "; " + found.remark;
  return text;
}

std::string structure_text(const FoundStructure& found, bool acted_on, int width) {
  std::string text = fmt::format("structure {}", structure_words(found, acted_on));
  if (found.by_drifting)
    text +=
        ": the fewest lags within next to nothing of the best of the training runs' forecasts with wandering "
        "coefficients "
        "(drifting), which are better than with constant ones";
  else if (!found.scores.empty())
    text += fmt::format(": the fewest lags within one standard error of the best of {} structures, by {} ({} samples)",
                        found.structures, left_out_words(found), found.samples);
  text += "\n";
  if (!found.scores.empty()) text += table_text(found, acted_on, width);
  if (found.feedback()) text += "          " + feedback_words(found) + "\n";
  if (!found.remark.empty()) text += "          " + found.remark + "\n";
  return text;
}

}  // namespace modebank::app
