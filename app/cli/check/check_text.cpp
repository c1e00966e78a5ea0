#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/cli/check/check_output.hpp"
#include "app/text/lag_text.hpp"
#include "app/text/text_units.hpp"
#include "ident/base/natural_order.hpp"

namespace modebank::app {
namespace {

constexpr std::size_t most_rows = 20;

std::string levels_text(const RunReport& run) {
  std::vector<Index> levels;
  for (const ChannelCheck& channel : run.input) levels.push_back(channel.levels);
  return fmt::format("{}", fmt::join(levels, "/"));
}

double most_saturated(const RunReport& run) {
  double most = 0.0;
  for (const double share : run.input_saturated) most = std::max(most, share);
  for (const double share : run.state_saturated) most = std::max(most, share);
  return most;
}

Index outliers_of(const RunReport& run) {
  Index sum = 0;
  for (const ChannelCheck& channel : run.state) sum += channel.outliers;
  return sum;
}

std::string run_row(const RunReport& run, std::size_t width) {
  const auto both = [](Index a, Index b) { return std::to_string(a + b); };
  const bool joint = run.inputs.samples == run.states.samples && run.inputs.rate_hz == run.states.rate_hz;
  const Index faults_in_time = run.inputs.repeated_times + run.inputs.backward_times + run.inputs.missing_times;
  const Index states_faults = run.states.repeated_times + run.states.backward_times + run.states.missing_times;
  return fmt::format(
      "{:<{}} {:<5} {:>6.0f} {:>6.4g} {:>6.4g} {:>6.1f} {:>4} {:>5} {:>5} {:>5.0f} {:>7.1f} {:>7} {:>5.1f} {:>4} "
      "{:>6.0f} "
      "{:>6}  {}\n",
      run.run, width, name_of(run.role), run.inputs.duration_s, run.inputs.rate_hz, run.states.rate_hz,
      percent * run.inputs.jitter, joint ? std::to_string(run.inputs.gaps) : both(run.inputs.gaps, run.states.gaps),
      joint ? std::to_string(faults_in_time) : both(faults_in_time, states_faults),
      both(run.inputs.missing_samples, run.states.missing_samples), percent * run.commands.still,
      run.commands.longest_constant_s, levels_text(run), percent * most_saturated(run), run.excitation,
      percent * run.windows.share(), outliers_of(run),
      lag_estimate_text(run.lag.lag_s, run.lag.lag_standard_error_s, run.lag.status));
}

std::string run_table(const DataCheck& check) {
  std::size_t width = 3;
  for (const RunReport& run : check.runs) width = std::max(width, run.run.size());
  std::string text = fmt::format(
      "{:<{}} {:<5} {:>6} {:>6} {:>6} {:>6} {:>4} {:>5} {:>5} {:>5} {:>7} {:>7} {:>5} {:>4} {:>6} {:>6}  {}\n", "run",
      width, "role", "s", "in Hz", "st Hz", "jit %", "gaps", "disor", "NaN", "rest%", "const s", "levels", "sat%",
      "exc", "defic%", "spikes", "lag s");
  std::vector<std::string> names;
  for (const RunReport& run : check.runs) names.push_back(run.run);
  std::size_t rows = 0;
  for (const std::size_t i : natural_order(names))
    if (++rows <= most_rows) text += run_row(check.runs[i], width);
  if (rows > most_rows) text += fmt::format("... and {} runs more (--json has all)\n", rows - most_rows);
  return text;
}

std::string channel_table(const DataCheck& check) {
  std::string text = fmt::format("{:<16} {:<5} {:>10} {:>10} {:>10} {:>10} {:>7} {:>8} {:>7}  {}\n", "channel", "kind",
                                 "least", "largest", "sd", "quantum", "levels", "repeats%", "spikes", "saturated");
  for (const ChannelSummary& channel : check.channels) {
    const ChannelCheck& c = channel.values;
    std::string saturated = "-";
    if (channel.saturated > 0.0)
      saturated = fmt::format("{:.1f} %{}{}", percent * channel.saturated,
                              std::isfinite(channel.limits.low) ? fmt::format(" <= {:.4g}", channel.limits.low) : "",
                              std::isfinite(channel.limits.high) ? fmt::format(" >= {:.4g}", channel.limits.high) : "");
    text += fmt::format("{:<16} {:<5} {:>10.4g} {:>10.4g} {:>10.4g} {:>10} {:>7} {:>8.0f} {:>7}  {}\n",
                        channel.channel.name, channel.is_state ? "state" : "input", c.least, c.largest, c.sd,
                        c.quantum > 0.0 ? fmt::format("{:.6g}", c.quantum) : "-", c.levels, percent * c.repeated,
                        c.outliers, saturated);
  }
  return text;
}

}  // namespace

std::string check_text(const DataCheck& check, const std::vector<std::string>& findings) {
  Index transitions = 0;
  for (const RunReport& run : check.runs) transitions += run.transitions;
  const auto trains =
      std::count_if(check.runs.begin(), check.runs.end(), [](const RunReport& run) { return run.role == Role::train; });
  std::string text = fmt::format("data check: {} runs ({} training runs), {} transitions when joined\n\n",
                                 check.runs.size(), trains, transitions);
  text += run_table(check) +
          fmt::format(
              "  rest: all inputs zero; const: longest constant command in motion; levels, sat: distinct and saturated "
              "values;\n  exc: order of persistent excitation (10: or more); defic: rank-deficient windows of {} "
              "transitions; lag: dead\n  time of the inputs, + later\n\n",
              check.window_length);
  text += channel_table(check) + "\n";
  if (check.has_lag) text += lag_text(check.lag, false);
  text += "\nfindings\n";
  for (const std::string& finding : findings) text += "- " + finding + "\n";
  if (findings.empty()) text += "- no finding\n";
  return text;
}

}  // namespace modebank::app
