#include "app/text/first_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <string_view>

#include "app/text/judged_runs.hpp"
#include "app/text/number_text.hpp"
#include "app/text/terminal.hpp"
#include "ident/base/characters.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank::app {
namespace {

constexpr int finding_lines = 5;
constexpr int least_mode_lines = 4;  // two of these lines are headings
constexpr int least_columns = 40;

int line_count(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }

/// Shortens lines to the width of the screen, even with long names. A tab in a name counts as a space.
std::string narrowed(std::string text, int columns) {
  std::replace(text.begin(), text.end(), '\t', ' ');
  std::vector<std::string> lines = lines_of(text);
  for (std::string& line : lines)
    if (columns_of(line) > columns) line = first_columns(line, columns - 3) + "...";
  return boost::algorithm::join(lines, "\n");
}

/// A labelled paragraph of at most `most` lines. A longer text is cut and ends in "..."; `show` prints all of it.
std::string section(const char* label, const std::string& text, int most, int columns) {
  if (text.empty()) return "";
  std::vector<std::string> lines = lines_of(wrapped(fmt::format("{:<10}{}", label, text), columns));
  if (static_cast<int>(lines.size()) > most) {
    lines.resize(static_cast<std::size_t>(most));
    lines.back() = first_columns(lines.back(), columns - 4) + " ...";
  }
  return narrowed(boost::algorithm::join(lines, "\n"), columns) + "\n";
}

std::string file_line(const std::string& file, int columns) {
  const std::string line = fmt::format("{:<10}{}", "archive", file), rest = "  (`modebank show` prints the rest)";
  return (columns_of(line + rest) <= columns ? line + rest : line) + "\n";
}

/// The section on modes, at most `lines` lines. Two of these are headings.
std::string modes_section(const Archive& archive, const FirstScreen& screen, int lines, int columns,
                          const std::string& unit) {
  const std::string simpler = archive.finding ? archive.finding->better_description : "";
  if (screen.modes.rows.empty() && !simpler.empty())
    return section(
        "modes",
        fmt::format("{} in the bank, which is not shown to predict better than `{}`; `modebank show` has them",
                    motion_words(*archive.bank), simpler),
        2, columns);
  const std::string indent(2, ' ');
  ShortModes modes = short_modes(archive, lines - 2, columns - static_cast<int>(indent.size()), unit);
  std::string& table = modes.text;
  boost::algorithm::trim_right(table);
  boost::replace_all(table, "\n", "\n" + indent);
  std::string head = motion_words(*archive.bank);
  if (head == counted_words(*archive.bank)) head = std::to_string(screen.mode_count);  // the label says "modes"
  head += fmt::format(" on {} {}", words_for(screen.role),
                      noun_of_runs(2, archive.recording && are_stretches(*archive.recording)));
  const bool units = !screen.modes.gain_unit.empty();
  if (units) head += fmt::format("; gains in {}", screen.modes.gain_unit);
  if (modes.gains_left_out > 0)
    head += units ? fmt::format(", {} more in `modebank show`", modes.gains_left_out)
                  : fmt::format("; `modebank show` has {} more column{} of gains", modes.gains_left_out,
                                modes.gains_left_out == 1 ? "" : "s");
  return section("modes", head, 1, columns) + narrowed(indent + table, columns) + "\n";
}

/// Whether a name is short and needs no quotes in a shell.
bool is_plain(const std::string& name) {
  constexpr std::size_t short_name = 32;
  return !name.empty() && name.size() <= short_name && std::all_of(name.begin(), name.end(), [](char c) {
    return is_letter(c) || is_digit(c) || std::string_view("_-./").find(c) != std::string_view::npos;
  });
}

/// Replaces placeholders, so that the commands can be typed. Commands use the program's name as the user called it, and
/// the name of the archive, unless it is long.
std::string as_typed(std::string text, const std::string& program, const std::string& file) {
  boost::replace_all(text, "`modebank ", "`" + program + " ");
  if (is_plain(file)) boost::replace_all(text, " ARCHIVE", " " + file);
  return text;
}

}  // namespace

std::string first_screen(const Archive& archive, const Settings& settings, const std::string& file, int width,
                         const std::string& program) {
  const FirstScreen screen = make_first_screen(archive, settings);
  const int columns = width > 0 ? std::clamp(width, least_columns, screen_columns) : screen_columns;
  const auto part = [&](const char* label, const std::string& text, int most) {
    return section(label, as_typed(text, program, file), most, columns);
  };
  const std::string point = screen.point.empty() ? "" : narrowed(std::string(10, ' ') + screen.point, columns) + "\n";
  const std::string before =
      part("doubt", screen.doubt, screen_lines) + part("read", screen.read, screen.inputs_ahead ? 3 : 2) +
      part("structure", screen.structure, 4) + point + part("finding", screen.finding, finding_lines);
  const std::string after =
      part("band", screen.band, 3) + part("mean", screen.mean, screen.free_run_start == 0 ? 3 : 4) +
      part("warning", screen.warning, screen_lines) + part("use", screen.use, screen_lines) + file_line(file, columns);
  const int mode_lines = std::max(screen_lines - line_count(before) - line_count(after), least_mode_lines);
  return before + modes_section(archive, screen, mode_lines, columns, time_unit(settings)) + after;
}

}  // namespace modebank::app
