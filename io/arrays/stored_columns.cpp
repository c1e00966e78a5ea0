#include "io/arrays/stored_columns.hpp"

#include <fmt/format.h>

namespace modebank {

namespace {

/// Position of the last part of a dotted path.
std::size_t last_part(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? 0 : dot + 1;
}

/// "signals", or "[0]" of "signals[0]", of a group's last part; empty when it is another.
std::string signal_of(const std::string& group) {
  const std::string part = group.substr(last_part(group));
  if (part == "signals") return part;
  return part.starts_with("signals[") ? part : std::string();
}

}  // namespace

void name_signals(std::vector<StoredColumn>& columns, const std::map<std::string, std::string>& labels) {
  for (StoredColumn& column : columns) {
    const std::string signal = signal_of(column.group);
    if (signal.empty() || !column.name.starts_with("values")) continue;
    const auto label = labels.find(column.group + ".label");
    const std::string shown = label == labels.end() || label->second.empty() ? signal : label->second;
    column.name = shown + column.name.substr(std::string("values").size());
    const std::size_t part = last_part(column.group);
    column.group.resize(part == 0 ? 0 : part - 1);
  }
}

std::string matlab_conversion(const std::string& class_name, const std::string& variable) {
  const std::string& x = variable;
  const std::string saved = fmt::format("save('{}_plain.mat', '-struct', 's')", x.substr(0, x.find_first_of(".[{(")));
  if (class_name == "timeseries") return fmt::format("s = struct('t', {0}.Time, 'x', {0}.Data); {1}", x, saved);
  if (class_name == "table") return fmt::format("s = table2struct({}, 'ToScalar', true); {}", x, saved);
  if (class_name == "timetable")
    return fmt::format(
        "s = table2struct(timetable2table({0}, 'ConvertRowTimes', false), 'ToScalar', true); "
        "s.t = seconds({0}.Properties.RowTimes - {0}.Properties.RowTimes(1)); {1}",
        x, saved);
  if (class_name == "datetime") return fmt::format("s.t = posixtime({}); {}", x, saved);
  if (class_name == "duration") return fmt::format("s.t = seconds({}); {}", x, saved);
  if (class_name == "string" || class_name == "categorical") return fmt::format("s.x = cellstr({}); {}", x, saved);
  if (class_name == "Simulink.SimulationData.Dataset")
    return fmt::format("s = struct('t', {0}{{1}}.Values.Time, 'x', {0}{{1}}.Values.Data); {1}", x, saved);
  return "";
}

}  // namespace modebank
