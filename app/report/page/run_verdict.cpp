#include <fmt/format.h>

#include "app/chain/judged_runs.hpp"
#include "app/report/page/numbers.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/report/page/unit_text.hpp"
#include "app/text/first_screen.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

/// One of the numbers that decide, for every filter.
json decisive(const Archive& archive, Role role, const std::string& name, const std::string& unit,
              const std::string& better, json (*of)(const SummaryRow&)) {
  json values = json::object();
  for (const SummaryRow& row : archive.summary)
    if (row.run == "*" && row.role == role) values[row.filter] = of(row);
  return {{"name", name}, {"unit", unit}, {"better", better}, {"values", values}};
}

/// What was found, as the archive says it, and whether the bank's uncertainty is false. Good: evidence, and calibrated.
json sentence(const Archive& archive) {
  if (!archive.finding) return {{"text", "No bank was scored, so there is nothing to judge yet."}, {"good", nullptr}};
  const Finding& finding = *archive.finding;
  std::string text = finding.text;
  bool good = finding.answer == Answer::evidence;
  if (const DiagnosticsRow* row = diagnosis(archive, "bank", finding.role)) {
    text += fmt::format(" Of the bank: {}.", calibration_words(row->verdict));
    good = good && row->verdict == Verdict::calibrated;
  }
  return {{"text", text}, {"good", good}, {"answer", name_of(finding.answer)}};
}

}  // namespace

nlohmann::json verdict_section(const Archive& archive) {
  const Role role = judged_role(archive);
  json section = sentence(archive);
  section["role"] = name_of(role);
  section["numbers"] = {
      decisive(archive, role, "Log score", "nats per sample", "higher is better",
               [](const SummaryRow& row) { return number(row.log_score); }),
      decisive(archive, role, "One-step RMSE", archive.recording ? common_unit(archive.recording->states) : "",
               "lower is better", [](const SummaryRow& row) { return number_list(row.rmse); }),
      decisive(archive, role, "In the 95 % band", "", "95 % is true",
               [](const SummaryRow& row) { return percent(row.coverage_95); }),
      decisive(archive, role, "Too far", "", "2.5 % is true",
               [](const SummaryRow& row) { return percent(row.too_far); }),
  };
  return section;
}

}  // namespace modebank::app::report
