#include "app/init/survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/init/words.hpp"
#include "ident/base/not_a_number.hpp"
#include "io/import/open_table.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// A table of more columns is read so many at a time.
constexpr std::size_t columns_at_once = 64;

/// Reads columns of a table; those that are no numbers are left out.
class TableSurvey {
 public:
  TableSurvey(const TableReader& reader, std::size_t position, const TableInfo& info, std::vector<std::string>& notes)
      : reader_(reader), position_(position), info_(info), notes_(notes) {}

  SurveyedTable look() {
    SurveyedTable table{info_.name, info_.type};
    for (const ColumnInfo& column : info_.columns) table.channels.push_back({column.name, column.unit, column.type});
    for (std::size_t first = 0; first < table.channels.size(); first += columns_at_once)
      read_numbers(table, first, std::min(first + columns_at_once, table.channels.size()));
    for (SurveyedChannel& channel : table.channels)
      if (channel.is_number()) channel.check = check_channel(channel.values);
    find_time(table);
    find_run(table);
    table.sampling = check_sampling(one_run(table));
    return table;
  }

 private:
  const TableReader& reader_;
  std::size_t position_;
  const TableInfo& info_;
  std::vector<std::string>& notes_;

  std::optional<Table> try_read(const TableRequest& request) {
    try {
      InputFile unused;
      std::vector<Table> tables = reader_.read({request}, unused);
      for (const std::string& note : tables.at(0).notes)
        if (std::find(notes_.begin(), notes_.end(), note) == notes_.end()) notes_.push_back(note);
      return std::move(tables.at(0));
    } catch (const DataError&) {
      return std::nullopt;
    }
  }

  /// All at once where that goes, else one by one to find which are text.
  void read_numbers(SurveyedTable& table, std::size_t first, std::size_t end) {
    TableRequest request;
    request.table = position_;
    for (std::size_t i = first; i < end; ++i)
      if (table.channels[i].type != "text") request.numbers.push_back(table.channels[i].name);
    request.may_miss.assign(request.numbers.size(), true);
    if (request.numbers.empty()) return;
    if (const std::optional<Table> all = try_read(request)) {
      std::size_t column = 0;
      for (std::size_t i = first; i < end; ++i)
        if (table.channels[i].type != "text") {
          const std::vector<double>& values = all->numbers[column++];
          table.channels[i].values = Eigen::VectorXd::Map(values.data(), std::ssize(values));
        }
      return;
    }
    if (end - first == 1) {
      table.channels[first].type = "text";
      return;
    }
    const std::size_t middle = first + (end - first) / 2;
    read_numbers(table, first, middle);
    read_numbers(table, middle, end);
  }

  /// Columns that may be times, the likeliest first: what the format calls so, then names.
  std::vector<std::vector<std::string>> time_candidates(const SurveyedTable& table) const {
    std::vector<std::vector<std::string>> typed, named;
    for (std::size_t i = 0; i < table.channels.size(); ++i) {
      const SurveyedChannel& channel = table.channels[i];
      if (channel.type == "time" && !channel.name.ends_with("receive_time")) typed.push_back({channel.name});
      if (!names_time(channel.name)) continue;
      if (i + 1 < table.channels.size() && names_nanoseconds(table.channels[i + 1].name))
        named.insert(named.begin(), {channel.name, table.channels[i + 1].name});
      else
        named.push_back({channel.name});
    }
    for (const SurveyedChannel& channel : table.channels)
      if (channel.type == "time" && channel.name.ends_with("receive_time")) typed.push_back({channel.name});
    typed.insert(typed.end(), named.begin(), named.end());
    return typed;
  }

  struct Times {
    std::vector<std::string> names;
    Eigen::VectorXd time_s;
    std::int64_t origin_ns;
  };

  static Eigen::Index jumps_back(const Eigen::VectorXd& time_s) {
    Eigen::Index count = 0;
    for (Eigen::Index k = 1; k < time_s.size(); ++k) count += jumps_back(time_s, k);
    return count;
  }
  static Eigen::Index stands_still(const Eigen::VectorXd& time_s) {
    Eigen::Index count = 0;
    for (Eigen::Index k = 1; k < time_s.size(); ++k) count += time_s(k) == time_s(k - 1);
    return count;
  }

  /// The first candidate that advances; one that jumps back now and then may be many runs' time.
  void find_time(SurveyedTable& table) {
    std::optional<Times> jumping;
    for (const std::vector<std::string>& candidate : time_candidates(table)) {
      TableRequest request;
      request.table = position_;
      request.time.column = candidate[0];
      request.time.nanoseconds = candidate.size() > 1 ? candidate[1] : "";
      request.time.may_miss = true;
      const std::optional<Table> read = try_read(request);
      if (!read || read->time_ns.size() < 2) continue;
      take_times(table, *read);
      table.time = candidate;
      const Eigen::Index jumps = jumps_back(table.time_s), stands = stands_still(table.time_s);
      if (stands > table.time_s.size() / 2) continue;
      if (jumps == 0) return;
      if (jumps < table.time_s.size() / 10 && !jumping) jumping = Times{candidate, table.time_s, table.origin_ns};
    }
    if (jumping) {
      table.time = jumping->names;
      table.time_s = jumping->time_s;
      table.origin_ns = jumping->origin_ns;
      return;
    }
    table.time.clear();
    table.origin_ns = 0;
    const Eigen::Index rows = row_count(table);
    table.time_s = Eigen::VectorXd::LinSpaced(rows, 0.0, static_cast<double>(std::max<Eigen::Index>(rows - 1, 0)));
  }

  static Eigen::Index row_count(const SurveyedTable& table) {
    for (const SurveyedChannel& channel : table.channels)
      if (channel.is_number()) return channel.values.size();
    return 0;
  }

  static void take_times(SurveyedTable& table, const Table& read) {
    table.time_s.resize(std::ssize(read.time_ns));
    table.origin_ns = missing_stamp;
    for (const std::int64_t stamp : read.time_ns)
      if (stamp != missing_stamp && (table.origin_ns == missing_stamp || stamp < table.origin_ns))
        table.origin_ns = stamp;
    for (std::size_t k = 0; k < read.time_ns.size(); ++k)
      table.time_s(static_cast<Eigen::Index>(k)) = read.time_ns[k] == missing_stamp
                                                       ? not_a_number
                                                       : static_cast<double>(read.time_ns[k] - table.origin_ns) / 1e9;
  }

  static bool jumps_back(const Eigen::VectorXd& time_s, Eigen::Index k) { return time_s(k) < time_s(k - 1); }

  /// A column that changes wherever time jumps back.
  void find_run(SurveyedTable& table) {
    std::vector<Eigen::Index> jumps;
    for (Eigen::Index k = 1; k < table.time_s.size(); ++k)
      if (jumps_back(table.time_s, k)) jumps.push_back(k);
    if (jumps.empty()) return;
    for (const bool named : {true, false})
      for (const SurveyedChannel& channel : table.channels) {
        if (named != names_run(channel.name)) continue;
        if (channel.is_number() ? separates(channel.values, jumps) : named && channel.type == "text") {
          table.run = channel.name;
          return;
        }
      }
  }

  static bool separates(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& jumps) {
    Eigen::Index changes = 0;
    for (Eigen::Index k = 1; k < values.size(); ++k) changes += values(k) != values(k - 1);
    return changes <= 2 * std::ssize(jumps) + 2 &&
           std::all_of(jumps.begin(), jumps.end(), [&](Eigen::Index k) { return values(k) != values(k - 1); });
  }

  /// The rows up to the first jump back of time.
  static Stream one_run(const SurveyedTable& table) {
    Eigen::Index end = std::min<Eigen::Index>(1, table.time_s.size());
    while (end < table.time_s.size() && !(!table.run.empty() && jumps_back(table.time_s, end))) ++end;
    Stream stream{table.time_s.head(end), Eigen::MatrixXd(0, end)};
    std::vector<const SurveyedChannel*> moving;
    for (const SurveyedChannel& channel : table.channels)
      if (channel.moves()) moving.push_back(&channel);
    stream.values.resize(std::ssize(moving), end);
    for (std::size_t i = 0; i < moving.size(); ++i)
      stream.values.row(static_cast<Eigen::Index>(i)) = moving[i]->values.head(end).transpose();
    return stream;
  }
};

}  // namespace

const SurveyedChannel* SurveyedTable::find(const std::string& channel) const {
  const auto found =
      std::find_if(channels.begin(), channels.end(), [&](const SurveyedChannel& c) { return c.name == channel; });
  return found == channels.end() ? nullptr : &*found;
}

SurveyedFile survey_file(const std::filesystem::path& path) {
  const std::shared_ptr<const TableReader> reader = open_table(path, FormatOptions());
  SurveyedFile file{path, {}, {}};
  const std::vector<TableInfo> tables = reader->tables();
  for (std::size_t i = 0; i < tables.size(); ++i)
    file.tables.push_back(TableSurvey(*reader, i, tables[i], file.notes).look());
  return file;
}

std::vector<std::string> all_columns(const std::filesystem::path& path) {
  std::vector<std::string> names;
  for (const TableInfo& table : open_table(path, FormatOptions())->tables())
    for (const ColumnInfo& column : table.columns) names.push_back(column.name);
  return names;
}

}  // namespace modebank::app
