#include "app/text/first_screen.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cstdlib>

#include "app/chain/judged_runs.hpp"
#include "app/text/mode_words.hpp"
#include "app/text/terminal.hpp"
#include "app/text/warnings.hpp"

namespace modebank::app {
namespace {

constexpr int finding_lines = 6;
constexpr int least_columns = 40;

int line_count(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }

/// Lines no wider than the screen, however long a name in them is; a tab in one counts as a space.
std::string narrowed(std::string text, int columns) {
  std::replace(text.begin(), text.end(), '\t', ' ');
  std::vector<std::string> lines = lines_of(text);
  for (std::string& line : lines)
    if (columns_of(line) > columns) line = first_columns(line, columns - 3) + "...";
  return boost::algorithm::join(lines, "\n");
}

/// A labelled paragraph of at most `most` lines; what does not fit ends in "..." (show has all of it).
std::string section(const char* label, const std::string& text, int most, int columns) {
  if (text.empty()) return "";
  std::vector<std::string> lines = lines_of(wrapped(fmt::format("{:<10}{}", label, text), columns));
  if (static_cast<int>(lines.size()) > most) {
    lines.resize(static_cast<std::size_t>(most));
    lines.back() = first_columns(lines.back(), columns - 4) + " ...";
  }
  return narrowed(boost::algorithm::join(lines, "\n"), columns) + "\n";
}

/// How much later than recorded inputs act: found, or said.
double input_lag(const Archive& archive, const Settings& settings) {
  if (archive.lag) return archive.lag->correction == LagCorrection::none ? 0.0 : archive.lag->lag.mean;
  const auto said = settings.find("data.lag_s");
  return said == settings.end() ? 0.0 : std::atof(said->second.c_str());
}

std::string read_words(const Archive& archive, const Settings& settings) {
  if (!archive.recording) return "";
  const Recording& recording = *archive.recording;
  const auto count = [&](Role role) {
    return std::count_if(recording.runs.begin(), recording.runs.end(),
                         [role](const Trajectory& t) { return t.role == role; });
  };
  const Index train = count(Role::train), test = count(Role::test);
  const Index steps = recording.transitions(Role::train), held_out = recording.transitions(Role::test);
  std::string text =
      test == 0 ? fmt::format("{} training run{}, none held out, {} steps", train, train == 1 ? "" : "s", steps)
                : fmt::format("{} training and {} held-out run{}, {} and {} steps", train, test, test == 1 ? "" : "s",
                              steps, held_out);
  text += fmt::format(" of {:.3g} s; {}", recording.median_period_s(), fmt::join(names_of(recording.states), ", "));
  if (!recording.inputs.empty()) text += fmt::format(" from {}", fmt::join(names_of(recording.inputs), ", "));
  if (archive.lag && archive.lag->correction != LagCorrection::none)
    text += fmt::format(", which act {:+.3f} s later", archive.lag->lag.mean);
  if (const double lag_s = input_lag(archive, settings); lag_s < 0.0)
    text += fmt::format("{}the filter needs inputs {:.3f} s ahead of the states", archive.lag ? ": " : "; ", -lag_s);
  if (archive.learned_transitions > 0)
    text += fmt::format("; the bank learned {}", learned_words(archive.learned_transitions, steps));
  if (archive.lag_counts)
    text += fmt::format("; lags found: {} of the state, {} of the inputs", archive.lag_counts->state_lags,
                        archive.lag_counts->input_lags);
  return text;
}

std::string verdict_words(Verdict verdict) {
  if (verdict == Verdict::undecided) return "undecided, for too few samples";
  return fmt::format("{}, {}", name_of(verdict), calibration_words(verdict));
}

std::string trust_words(const Archive& archive) {
  const DiagnosticsRow* row = diagnosis(archive, "bank", judged_role(archive));
  if (!row) return "";
  return fmt::format(
      "{:.1f} % [{:.1f}, {:.1f}] of the {} samples lie in the 95 % band: {}; {:.1f} % in the 50 %, {:.1f} % in the "
      "90 %, {:.1f} % in the 99 % band",
      100 * row->coverage_95, 100 * row->coverage_95_lower, 100 * row->coverage_95_upper, words_for(row->role),
      verdict_words(row->verdict), 100 * row->coverage_50, 100 * row->coverage_90, 100 * row->coverage_99);
}

/// "0.0301 rad/s", or per state "wz 0.0301 rad/s, v 0.2 m/s".
std::string rmse_words(const Eigen::VectorXd& rmse, const std::vector<Channel>& states) {
  std::vector<std::string> parts;
  for (Index i = 0; i < rmse.size(); ++i) {
    const Channel state = static_cast<std::size_t>(i) < states.size() ? states[static_cast<std::size_t>(i)] : Channel{};
    parts.push_back(fmt::format("{}{:.4g}{}", rmse.size() > 1 ? state.name + " " : "", rmse(i),
                                state.unit.empty() ? "" : " " + state.unit));
  }
  return boost::algorithm::join(parts, ", ");
}

const HorizonRow* longest_horizon(const Archive& archive, const std::string& filter, Role role) {
  const HorizonRow* longest = nullptr;
  for (const HorizonRow& row : archive.horizons)
    if (row.filter == filter && row.role == role && row.run == "*" && row.horizon > (longest ? longest->horizon : 1))
      longest = &row;
  return longest;
}

const FreeRunRow* free_run_of(const Archive& archive, const std::string& filter, Role role) {
  const auto found = std::find_if(archive.free_runs.begin(), archive.free_runs.end(), [&](const FreeRunRow& row) {
    return row.filter == filter && row.role == role && row.run == "*";
  });
  return found == archive.free_runs.end() ? nullptr : &*found;
}

/// "; free run from 3 samples FIT 71.2 % (drifting: 65.0 %)"
std::string free_run_words(const Archive& archive, const std::string& best, Role role) {
  const auto fit = [](const FreeRunRow& row) {
    std::vector<std::string> parts;
    for (const double percent : row.fit) parts.push_back(fmt::format("{:.1f} %", percent));
    return boost::algorithm::join(parts, ", ");
  };
  const FreeRunRow* bank = free_run_of(archive, "bank", role);
  if (!bank) return "";
  const FreeRunRow* other = free_run_of(archive, best, role);
  return fmt::format("; free run from {} samples FIT {}{}", bank->start, fit(*bank),
                     other ? fmt::format(" ({}: {})", best, fit(*other)) : "");
}

std::string mean_words(const Archive& archive) {
  const Role role = judged_role(archive);
  const std::string best = archive.finding ? archive.finding->best_competitor : "";
  const SummaryRow* bank = pooled_row(archive, "bank", role);
  if (!bank) return "";
  const std::vector<Channel> states = archive.recording ? archive.recording->states : std::vector<Channel>();
  const auto beside = [&](const auto* row) {
    return row ? fmt::format(" ({}: {})", best, rmse_words(row->rmse, states)) : std::string();
  };
  std::string text =
      fmt::format("RMSE one step ahead {}{}", rmse_words(bank->rmse, states), beside(pooled_row(archive, best, role)));
  if (const HorizonRow* far = longest_horizon(archive, "bank", role))
    text += fmt::format("; {} steps ahead {}{}", far->horizon, rmse_words(far->rmse, states),
                        beside(longest_horizon(archive, best, role)));
  return text + free_run_words(archive, best, role);
}

std::string warning_words(const Archive& archive) {
  const std::vector<std::string> warnings = archive_warnings(archive);
  if (warnings.empty()) return "";
  return warnings.size() == 1
             ? warnings.front()
             : fmt::format("{}, the first: {} (`modebank show` has all)", warnings.size(), warnings.front());
}

std::string file_line(const std::string& file, int columns) {
  const std::string line = fmt::format("{:<10}{}", "archive", file), rest = "  (`modebank show` prints the rest)";
  return (columns_of(line + rest) <= columns ? line + rest : line) + "\n";
}

/// At most `lines` lines, two of them headings.
std::string modes_section(const Archive& archive, int lines, int columns) {
  const Bank& bank = *archive.bank;
  const std::string indent(2, ' ');
  ShortModes modes = short_modes(archive, lines - 2, columns - static_cast<int>(indent.size()));
  std::string& table = modes.text;
  boost::algorithm::trim_right(table);
  boost::replace_all(table, "\n", "\n" + indent);
  const GainNames gains = gain_names(bank, archive.recording ? archive.recording->states : std::vector<Channel>(),
                                     archive.recording ? archive.recording->inputs : std::vector<Channel>());
  std::string head = fmt::format("{} on {} runs", bank.mode_count(), words_for(judged_role(archive)));
  if (!gains.unit.empty()) head += fmt::format("; steady gains in {}", gains.unit);
  if (modes.gains_left_out > 0)
    head += fmt::format("; `modebank show` has {} more columns of gains", modes.gains_left_out);
  return section("modes", head, 1, columns) + narrowed(indent + table, columns) + "\n";
}

}  // namespace

std::string calibration_words(Verdict verdict) {
  switch (verdict) {
    case Verdict::calibrated:
      return "its stated uncertainty is not found false";
    case Verdict::overconfident:
      return "it claims more certainty than it has";
    case Verdict::underconfident:
      return "it claims less certainty than it has";
    case Verdict::undecided:
      break;
  }
  return "whether its stated uncertainty is false is undecided";
}

bool has_first_screen(const Archive& archive) { return archive.bank && !archive.summary.empty(); }

std::string first_screen(const Archive& archive, const Settings& settings, const std::string& file, int width,
                         const std::string& program) {
  const int columns = width > 0 ? std::clamp(width, least_columns, screen_columns) : screen_columns;
  const auto part = [columns](const char* label, const std::string& text, int most) {
    return section(label, text, most, columns);
  };
  const std::string before = part("read", read_words(archive, settings), input_lag(archive, settings) < 0.0 ? 3 : 2) +
                             part("finding", archive.finding ? archive.finding->text : "", finding_lines);
  const std::string after =
      part("band", trust_words(archive), 3) + part("mean", mean_words(archive), archive.free_runs.empty() ? 2 : 3) +
      part("warning", warning_words(archive), 2) +
      part("next", boost::replace_all_copy(next_step(archive, settings), "`modebank ", "`" + program + " "),
           program == "modebank" ? 2 : 3) +
      file_line(file, columns);
  return before + modes_section(archive, screen_lines - line_count(before) - line_count(after), columns) + after;
}

}  // namespace modebank::app
