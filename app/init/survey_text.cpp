#include "app/init/survey_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "ident/base/printable.hpp"

namespace modebank::app {
namespace {

/// The name of an array element without its index: covariance for covariance[3].
std::string array_of(const std::string& name) {
  return name.ends_with("]") ? name.substr(0, name.rfind('[')) : std::string();
}

struct Row {
  std::string name, unit, content;
};

Row row_of(const SurveyedChannel& channel, const SurveyedTable& table) {
  const std::string name = printable_name(channel.name);
  const bool is_time = std::ranges::count(table.time, channel.name) > 0;
  if (channel.type == "time" || is_time) return {name, "", "times"};
  if (!channel.is_number())
    return {name, "", channel.why_text.empty() ? "text" : "text: " + printable_name(channel.why_text)};
  std::string notes;
  if (channel.check.missing > 0) notes += fmt::format("  {} missing", channel.check.missing);
  if (channel.check.quantum > 0.0) notes += fmt::format("  by {:.4g}", channel.check.quantum);
  if (channel.check.repeated > most_repeated && channel.moves())
    notes += fmt::format("  {:.0f} % repeated", 100.0 * channel.check.repeated);
  const std::string range = channel.check.largest > channel.check.least
                                ? fmt::format("{:.5g} to {:.5g}", channel.check.least, channel.check.largest)
                                : fmt::format("constant {:.5g}", channel.check.least);
  return {name, channel.unit, range + notes};
}

/// If no element of an array moves, its elements share a row.
std::vector<Row> rows_of(const SurveyedTable& table) {
  const std::vector<SurveyedChannel>& channels = table.channels;
  std::vector<Row> rows;
  for (std::size_t first = 0; first < channels.size();) {
    const std::string array = array_of(channels[first].name);
    std::size_t end = first;
    while (!array.empty() && end < channels.size() && array_of(channels[end].name) == array &&
           channels[end].is_number() && !channels[end].moves())
      ++end;
    if (end > first + 1)
      rows.push_back({printable_name(array) + "[]", channels[first].unit, fmt::format("{} constants", end - first)});
    else
      rows.push_back(row_of(channels[first], table));
    first = std::max(end, first + 1);
  }
  return rows;
}

/// A text table in which each column is as wide as its widest cell.
std::string rows_text(const SurveyedTable& table) {
  const std::vector<Row> rows = rows_of(table);
  std::size_t name = 0, unit = 0;
  for (const Row& row : rows) {
    name = std::max(name, row.name.size());
    unit = std::max(unit, row.unit.size());
  }
  std::string text;
  for (const Row& row : rows)
    text += fmt::format("  {:<{}}  {:<{}}{}\n", row.name, name, row.unit, unit == 0 ? 0 : unit + 2, row.content);
  return text;
}

}  // namespace

std::string survey_text(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed) {
  std::string text;
  for (std::size_t i = 0; i < surveyed.size(); ++i) {
    text += surveyed[i].path.string();
    if (sets[i].files.size() > 1)
      text += fmt::format(" and {} more; rows, rate and time of this file, ranges over all", sets[i].files.size() - 1);
    text += "\n";
    for (const std::string& note : surveyed[i].notes) text += fmt::format("  {}\n", note);
    for (const SurveyedTable& table : surveyed[i].tables) {
      const SamplingCheck& rows = table.sampling;
      const std::string name =
          table.name.empty() ? "" : table.name + (table.type.empty() ? "" : " (" + table.type + ")") + ": ";
      const std::string time = table.time.empty() ? "no times"
                                                  : fmt::format("{:.4g} Hz by {}, {:.4g} s, {} gap{}", rows.rate_hz,
                                                                fmt::join(table.time, " + "), rows.duration_s,
                                                                rows.gaps, rows.gaps == 1 ? "" : "s");
      const std::string unset =
          table.unset_rows == 0 ? ""
                                : fmt::format("; {} rows left out, stamped before the clock was set", table.unset_rows);
      text += fmt::format(" {}{} rows, {}{}{}\n", name, table.time_s.size(), time,
                          table.run.empty() ? "" : fmt::format(", runs by {}", table.run), unset);
      text += rows_text(table);
    }
  }
  return text;
}

}  // namespace modebank::app
