#include "app/text/lag_text.hpp"

#include <fmt/format.h>

namespace modebank::app {

std::string lag_estimate_text(double lag_s, double standard_error_s, LagStatus status) {
  switch (status) {
    case LagStatus::converged:
      return fmt::format("{:+.3f} +- {:.3f}", lag_s, standard_error_s);
    case LagStatus::at_edge:
      return fmt::format("beyond {:+.2f}?", lag_s);
    case LagStatus::not_excited:
      return "- (not excited)";
    case LagStatus::not_estimated:
      return "-";
  }
  return "";
}

std::string lag_text(const LagReport& report, bool done) {
  std::string text = "lag       ";
  if (report.lag.count == 0)
    text += "no training run has enough excitation to estimate one";
  else
    text += fmt::format(
        "inputs act {:+.3f} +- {:.3f} s later ({} training runs, which differ by {})", report.lag.mean,
        report.lag.standard_error, report.lag.count,
        report.lag.between_sd > 0.0 ? fmt::format("{:.3f} s", report.lag.between_sd) : "no more than their errors");
  if (report.lag.count > 0 && report.lag.mean < 0.0 && report.correction != LagCorrection::none)
    text += fmt::format("; their stamps are late: when filtering live, delay the states by {:.3f} s", -report.lag.mean);
  text += fmt::format("\n          {}{}\n          log score", done ? "applied: " : "data.lag_s = auto would apply ",
                      report.correction == LagCorrection::none
                          ? "nothing: the pooled lag gains no more than its standard error in cross-validation"
                          : "the pooled lag to every run");
  for (const LagScore& score : report.scores) {
    text += fmt::format("{} {} {:.3f}", score.correction == LagCorrection::none ? "" : ",", name_of(score.correction),
                        score.log_score);
    if (score.correction != LagCorrection::none)
      text += fmt::format(" ({:+.3f} +- {:.3f})", score.gain, score.gain_standard_error);
  }
  return text + "\n";
}

}  // namespace modebank::app
