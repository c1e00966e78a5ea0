#include "io/import/derived.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "ident/base/nearest_name.hpp"
#include "ident/base/not_a_number.hpp"
#include "io/table/number.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

[[noreturn]] void fail_form(const std::string& line, const char* what) {
  throw ConfigurationError(
      fmt::format("data.derive = {}: {}; expected NAME [unit] = EXPRESSION", line.substr(0, 100), what));
}

}  // namespace

DerivedChannel parse_derived(const std::string& line) {
  std::string_view rest = without_blanks(line);
  const std::string name = take_channel_name(rest);
  if (name.empty()) fail_form(line, "the name is missing (letters, digits, _ and ., or any text in single quotes)");
  rest = without_blanks(rest);
  std::string unit;
  if (rest.starts_with("[")) {
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos) fail_form(line, "the bracket of the unit is not closed");
    unit = without_blanks(rest.substr(1, end - 1));
    rest = without_blanks(rest.substr(end + 1));
  }
  if (!rest.starts_with("=") || rest.starts_with("==")) fail_form(line, "there is no = after the name");
  return {name, unit, Expression("data.derive, " + name, without_blanks(rest.substr(1)))};
}

DerivedChannels::DerivedChannels(const DataOptions& options) {
  for (const std::string& line : options.derive) {
    DerivedChannel channel = parse_derived(line);
    if (find(channel.name) != nullptr)
      throw ConfigurationError(fmt::format("data.derive: {} is defined twice", channel.name));
    channels_.push_back(std::move(channel));
  }
  for (std::size_t i = 0; i < channels_.size(); ++i)
    for (const std::string& used : channels_[i].expression.channels())
      for (std::size_t later = i; later < channels_.size(); ++later)
        if (channels_[later].name == used)
          throw ConfigurationError(fmt::format(
              "data.derive: {} uses {}, but a derived channel may only use earlier ones{}", channels_[i].name,
              later == i ? "itself" : used, later == i ? "" : fmt::format("; put the line of {} before it", used)));
  if (!options.where.empty()) where_.emplace(DerivedChannel{"", "", Expression("data.where", options.where)});
}

const DerivedChannel* DerivedChannels::find(const std::string& name) const {
  const auto found =
      std::find_if(channels_.begin(), channels_.end(), [&](const DerivedChannel& c) { return c.name == name; });
  return found == channels_.end() ? nullptr : &*found;
}

std::vector<std::string> DerivedChannels::names() const {
  std::vector<std::string> names;
  for (const DerivedChannel& channel : channels_) names.push_back(channel.name);
  return names;
}

namespace {

using Rows = std::vector<std::size_t>;

/// The rows of each run, in order of time.
std::vector<Rows> ordered_runs(const Table& table, std::optional<std::size_t> run, const std::vector<double>& time_s) {
  std::vector<Rows> runs;
  if (!run) {
    Rows& all = runs.emplace_back(table.rows());
    std::iota(all.begin(), all.end(), std::size_t{0});
  } else {
    std::map<std::string, Rows> by_name;
    for (std::size_t row = 0; row < table.rows(); ++row) by_name[table.texts[*run][row]].push_back(row);
    for (auto& [name, rows] : by_name) runs.push_back(std::move(rows));
  }
  for (Rows& rows : runs)
    std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return time_s[a] < time_s[b]; });
  return runs;
}

/// Times are seconds from the first stamp, because nanoseconds since 1970 would lose precision.
std::vector<double> seconds_of(const Table& table, double rate_hz) {
  std::vector<double> time_s(table.rows());
  std::int64_t first = missing_stamp;
  for (const std::int64_t stamp : table.time_ns)
    if (stamp != missing_stamp && first == missing_stamp) first = stamp;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    if (table.time_ns.empty())
      time_s[k] = static_cast<double>(k) / (rate_hz > 0.0 ? rate_hz : 1.0);
    else
      // Rows without a time are sorted to the end and have no neighbours.
      time_s[k] = table.time_ns[k] == missing_stamp ? HUGE_VAL : static_cast<double>(table.time_ns[k] - first) / 1e9;
  }
  return time_s;
}

std::vector<double> picked(const std::vector<double>& values, const Rows& rows) {
  std::vector<double> result;
  for (const std::size_t row : rows) result.push_back(values[row]);
  return result;
}

}  // namespace

TableRequest columns_to_read(const TableRequest& request, const std::vector<DerivedColumn>& derived) {
  TableRequest reduced = request;
  for (auto column = derived.rbegin(); column != derived.rend(); ++column) {
    const auto position = static_cast<std::ptrdiff_t>(column->position);
    reduced.numbers.erase(reduced.numbers.begin() + position);
    if (!reduced.may_miss.empty()) reduced.may_miss.erase(reduced.may_miss.begin() + position);
  }
  return reduced;
}

void derive_columns(const std::string& file, const TableRequest& request, const std::vector<DerivedColumn>& derived,
                    const RowOrder& order, Table& table) {
  if (derived.empty()) return;
  const bool borrowed = table.time_ns.empty() && order.clock.rows() == table.rows();
  const std::vector<double> time_s = seconds_of(borrowed ? order.clock : table, order.rate_hz);
  const std::vector<Rows> runs = ordered_runs(table, order.run, time_s);
  for (const DerivedColumn& column : derived) {
    std::vector<double> values(table.rows(), not_a_number);
    for (const Rows& rows : runs) {
      std::vector<std::vector<double>> operands;
      for (const std::size_t operand : column.operands) operands.push_back(picked(table.numbers[operand], rows));
      const std::vector<double> of_run = column.channel->expression.evaluate(
          std::vector<std::span<const double>>(operands.begin(), operands.end()), picked(time_s, rows));
      for (std::size_t k = 0; k < rows.size(); ++k) values[rows[k]] = of_run[k];
    }
    const bool may_miss = column.position < request.may_miss.size() && request.may_miss[column.position];
    const auto missing = std::find_if(values.begin(), values.end(), [](double v) { return std::isnan(v); });
    if (!may_miss && missing != values.end())
      throw DataError(fmt::format("{}:{}: {}: no finite value", file,
                                  table.line[static_cast<std::size_t>(missing - values.begin())],
                                  column.channel->expression.key()));
    table.numbers.insert(table.numbers.begin() + static_cast<std::ptrdiff_t>(column.position), std::move(values));
  }
}

}  // namespace modebank
