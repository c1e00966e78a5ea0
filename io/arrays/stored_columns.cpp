#include "io/arrays/stored_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/arrays/array_reader.hpp"

namespace modebank {

bool is_time(const StoredColumn& column) { return !column.text && is_time_name(column.name); }

void add_sample_times(std::vector<StoredColumn>& columns, const std::map<std::string, double>& sample_time) {
  for (const auto& [group, step_s] : sample_time) {
    if (!(step_s > 0.0) || !std::isfinite(step_s)) continue;
    std::map<std::uint64_t, std::size_t> lengths;
    bool timed = false;
    for (const StoredColumn& column : columns) {
      const bool inside = column.group == group || group.empty() || column.group.starts_with(group + ".") ||
                          column.group.starts_with(group + "[");
      if (!inside || column.text) continue;
      ++lengths[column.rows];
      timed = timed || is_time(column);
    }
    if (timed || lengths.empty()) continue;
    const auto commonest = std::max_element(lengths.begin(), lengths.end(),
                                            [](const auto& a, const auto& b) { return a.second < b.second; });
    StoredColumn& time = columns.emplace_back(StoredColumn{group, "time", "double", "s", commonest->first});
    time.scale = time.step_s = step_s;
  }
}

std::string not_a_table(const std::string& name, const std::string& read, const std::string& cells) {
  return fmt::format(
      R"py({0} is no table, but cells, rows of samples or three-dimensional, and not read: python3 -c "{1}
import numpy as np
for i, b in enumerate({2} if getattr(a, 'dtype', object) == object else [a]):
  np.savetxt(f'{0}_{{i}}.csv', np.moveaxis(b, np.argmax(b.shape), 0).reshape(max(b.shape), -1), delimiter=',')")py",
      name, read, cells);
}

std::string matlab_conversion(const std::string& class_name, const std::string& variable) {
  const std::string& x = variable;
  const std::string saved = fmt::format("save {}_plain s -v7", x.substr(0, x.find_first_of(".[{(")));
  if (class_name == "iddata")
    return fmt::format("s = struct('y', {0}.OutputData, 'u', {0}.InputData, 'Ts', {0}.Ts); {1}", x, saved);
  if (class_name == "timeseries") return fmt::format("s = struct('t', {0}.Time, 'x', {0}.Data); {1}", x, saved);
  if (class_name == "table") return fmt::format("s = table2struct({}, 'ToScalar', true); {}", x, saved);
  if (class_name == "timetable")
    return fmt::format(
        "s = table2struct(timetable2table({0}, 'ConvertRowTimes', false), 'ToScalar', true); "
        "s.t = seconds({0}.Properties.RowTimes - {0}.Properties.RowTimes(1)); {1}",
        x, saved);
  if (class_name == "datetime") return fmt::format("s = struct('t', posixtime({})); {}", x, saved);
  if (class_name == "duration") return fmt::format("s = struct('t', seconds({})); {}", x, saved);
  if (class_name == "string" || class_name == "categorical")
    return fmt::format("s = struct('x', {{cellstr({})}}); {}", x, saved);
  if (class_name == "Simulink.SimulationData.Dataset")
    return fmt::format("s = struct('t', {0}{{1}}.Values.Time, 'x', {0}{{1}}.Values.Data); {1}", x, saved);
  return "";
}

namespace {

std::string read_iddata_line(const std::string& file) {
  return fmt::format(
      "import modebank; [run.to_csv(name + '.csv', index=False) for name, run in modebank.read_iddata('{}').items()]",
      file);
}

}  // namespace

std::string matlab_object(const std::string& class_name, const std::string& variable, const std::string& file) {
  const std::string what = fmt::format("{} is a MATLAB {}", variable, class_name.empty() ? "object" : class_name);
  const std::string line = matlab_conversion(class_name, variable);
  if (class_name.empty())  // matio does not return the object's class
    return fmt::format(
        "{} (class({}) names its kind): convert an iddata in MATLAB with {}   or by python3 -c \"{}\"; a timeseries "
        "with {}",
        what, variable, matlab_conversion("iddata", variable), read_iddata_line(file),
        matlab_conversion("timeseries", variable));
  if (line.empty())
    return fmt::format(
        "{}, whose numbers cannot be read from this file; extract them in MATLAB, for a timeseries with {}", what,
        matlab_conversion("timeseries", variable));
  std::string python;
  if (class_name == "iddata" && !file.empty()) python = read_iddata_line(file);
  if (class_name == "table" || class_name == "timetable")
    python = fmt::format("import matio; matio.load_from_mat('{}')['{}'].to_csv('{}.csv')", file, variable, variable);
  return fmt::format("{}: convert it in MATLAB with {}{}", what, line,
                     python.empty() ? ""
                                    : fmt::format("   or by python3 -c \"{}\"{}", python,
                                                  class_name == "iddata" ? "" : " (package mat-io)"));
}

std::string matlab_objects_without_name() {
  return fmt::format(
      "the file contains MATLAB objects (table, timetable, timeseries, string, ...) without names; convert them in "
      "MATLAB, a table T with {}; a timeseries x with {}",
      matlab_conversion("table", "T"), matlab_conversion("timeseries", "x"));
}

}  // namespace modebank
