#include <fmt/format.h>

#include "app/chain/judged_runs.hpp"
#include "app/report/page/numbers.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/report/page/unit_text.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

const DiagnosticsRow* diagnosis(const Archive& archive, const std::string& filter, Role role) {
  for (const DiagnosticsRow& row : archive.diagnostics)
    if (row.filter == filter && row.role == role && row.mode < 0) return &row;
  return nullptr;
}

/// One of the numbers that decide, for every filter.
json decisive(const Archive& archive, Role role, const std::string& name, const std::string& unit,
              const std::string& better, json (*of)(const SummaryRow&)) {
  json values = json::object();
  for (const char* filter : {"bank", "baseline", "noise_only"})
    if (const SummaryRow* row = pooled_row(archive, filter, role)) values[filter] = of(*row);
  return {{"name", name}, {"unit", unit}, {"better", better}, {"values", values}};
}

std::string calibration_words(const DiagnosticsRow& row) {
  switch (row.verdict) {
    case Verdict::calibrated:
      return "its stated uncertainty is true";
    case Verdict::overconfident:
      return "it claims more certainty than it has";
    case Verdict::underconfident:
      return "it claims less certainty than it has";
    case Verdict::undecided:
      break;
  }
  return "whether its stated uncertainty is true is undecided";
}

/// The finding in one sentence, from the archive's own verdict.
json sentence(const Archive& archive) {
  const std::optional<BankGain> gain = bank_gain(archive.summary);
  if (!gain) return {{"text", "No bank was scored, so there is nothing to judge yet."}, {"good", nullptr}};
  std::string text = fmt::format("On {} runs the bank of {} modes", words_for(gain->role),
                                 archive.bank ? archive.bank->mode_count() : 0);
  bool good = gain->held_out();
  if (gain->over_baseline) {
    text += fmt::format(" predicts {} than one Kalman filter ({:+.3f} nats per sample)",
                        gain->predicts_better() ? "better" : "no better", *gain->over_baseline);
    good = good && gain->predicts_better();
  }
  if (gain->over_noise_only) {
    text += fmt::format(", {} evidence for modes of motion beyond changing noise ({:+.3f})",
                        gain->speaks_for_modes() ? "with" : "without", *gain->over_noise_only);
    good = good && gain->speaks_for_modes();
  }
  if (const DiagnosticsRow* row = diagnosis(archive, "bank", gain->role)) {
    text += fmt::format("; {}", calibration_words(*row));
    good = good && row->verdict == Verdict::calibrated;
  }
  text += gain->held_out() ? "." : ". Nothing was held out, so none of this is evidence.";
  return {{"text", text}, {"good", good}};
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
      decisive(archive, role, "PIT tail above", "", "2.5 % is true",
               [](const SummaryRow& row) { return percent(row.tail_above); }),
      decisive(archive, role, "PIT tail below", "", "2.5 % is true",
               [](const SummaryRow& row) { return percent(row.tail_below); }),
  };
  return section;
}

}  // namespace modebank::app::report
