#include "app/init/survey.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/init/words.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"
#include "io/import/open_table.hpp"
#include "io/import/read_columns.hpp"
#include "io/import/stamp_check.hpp"
#include "io/table/stamp_pattern.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// Surveys the columns of one table.
class TableSurvey {
 public:
  /// `columns`: the columns that were read. Their values are moved out.
  TableSurvey(const TableReader& reader, std::size_t position, const TableInfo& info, std::vector<FileColumn>& columns)
      : reader_(reader), position_(position), info_(info), columns_(columns) {}

  SurveyedTable look() {
    SurveyedTable table{info_.name, info_.type};
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const ColumnInfo& column = info_.columns[i];
      table.channels.push_back({column.name, column.unit, column.type, {}, numbers_of(columns_[i])});
      SurveyedChannel& channel = table.channels.back();
      if (channel.is_number()) {
        channel.check = check_channel(channel.values);
        channel.counts = counts_up(channel.values);
      } else {
        channel.type = "text";
        if (const auto* texts = std::get_if<std::vector<std::string>>(&columns_[i]))
          channel.why_text = why_no_numbers(*texts);
      }
      if (auto* const numbers = std::get_if<std::vector<double>>(&columns_[i])) *numbers = {};
    }
    find_time(table);
    leave_out_unset(table);
    find_run(table);
    const Eigen::VectorXd stamps_s = table.time_s.array() + 1e-9 * static_cast<double>(table.origin_ns);
    const std::vector<double> times(stamps_s.begin(), stamps_s.end());
    const bool runs = !table.run.empty() || !clock_restarts(times, table.time_notes).empty();
    table.sampling = check_sampling(one_run(table, runs));
    for (SurveyedChannel& channel : table.channels) channel.rests = rests_in_runs(channel.values, table);
    return table;
  }

 private:
  const TableReader& reader_;
  std::size_t position_;
  const TableInfo& info_;
  std::vector<FileColumn>& columns_;
  std::string time_problem_;

  /// The stamps of a column in seconds.
  static Eigen::VectorXd numbers_of(const FileColumn& column) {
    if (const auto* numbers = std::get_if<std::vector<double>>(&column))
      return Eigen::VectorXd::Map(numbers->data(), std::ssize(*numbers));
    const auto* stamps = std::get_if<std::vector<std::int64_t>>(&column);
    Eigen::VectorXd seconds(stamps == nullptr ? 0 : std::ssize(*stamps));
    for (Eigen::Index k = 0; k < seconds.size(); ++k) {
      const std::int64_t stamp = (*stamps)[static_cast<std::size_t>(k)];
      seconds(k) = stamp == missing_stamp ? not_a_number : static_cast<double>(stamp) / 1e9;
    }
    return seconds;
  }

  /// The stamps of a candidate. If its column was already read, the values are reused.
  Table stamps_of(const std::vector<std::string>& candidate) {
    Table result;
    for (std::size_t i = 0; candidate.size() == 1 && i < columns_.size(); ++i)
      if (info_.columns[i].name == candidate[0])
        if (const auto* stamps = std::get_if<std::vector<std::int64_t>>(&columns_[i])) {
          result.time_ns = *stamps;
          return result;
        }
    TableRequest request;
    request.table = position_;
    request.time.column = candidate[0];
    request.time.second = candidate.size() > 1 ? candidate[1] : "";
    request.time.may_miss = true;
    try {
      return std::move(reader_.read({request}, nullptr).at(0));
    } catch (const DataError& error) {
      if (time_problem_.empty()) time_problem_ = error.what();
      return {};
    }
  }

  /// Columns that may be times, the likeliest first. Columns of a time type come before columns with names of times.
  std::vector<std::vector<std::string>> time_candidates(const SurveyedTable& table) const {
    std::vector<std::vector<std::string>> typed, named;
    for (std::size_t i = 0; i < table.channels.size(); ++i) {
      const SurveyedChannel& channel = table.channels[i];
      if (channel.type == "time" && !channel.name.ends_with("receive_time")) typed.push_back({channel.name});
      const SurveyedChannel* const next = i + 1 < table.channels.size() ? &table.channels[i + 1] : nullptr;
      const bool pair = next != nullptr && channel.counts && channel.check.least > 9e8 && channel.check.largest < 4e9 &&
                        next->check.largest > 5e8 && next->check.largest < 1e9;  // seconds since 1970 and nanoseconds
      if (!names_time(channel.name) && !pair) continue;
      if (pair || (next != nullptr && names_nanoseconds(next->name)))
        named.insert(named.begin(), {channel.name, next->name});
      else if (const std::string date = date_beside(table, i); !date.empty())
        named.insert(named.begin(), {date, channel.name});
      else
        named.push_back({channel.name});
    }
    for (const SurveyedChannel& channel : table.channels)
      if (channel.type == "time" && channel.name.ends_with("receive_time")) typed.push_back({channel.name});
    typed.insert(typed.end(), named.begin(), named.end());
    for (std::size_t i = 0; i < table.channels.size(); ++i)
      if (!names_time(table.channels[i].name) && begins_with_time(i)) typed.push_back({table.channels[i].name});
    return typed;
  }

  /// Whether a text column begins with a time of day or a date. Its name does not matter.
  bool begins_with_time(std::size_t column) const {
    const auto* texts = std::get_if<std::vector<std::string>>(&columns_[column]);
    return texts != nullptr && !texts->empty() && is_known_time(texts->front());
  }

  /// If a text column has times of day, the name of the text column beside it that has dates.
  static std::string date_beside(const SurveyedTable& table, std::size_t time) {
    for (const std::size_t i : {time - 1, time + 1})
      if (i < table.channels.size() && names_date(table.channels[i].name) && table.channels[i].type == "text" &&
          table.channels[time].type == "text")
        return table.channels[i].name;
    return {};
  }

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

  /// Takes the first candidate with increasing times. A candidate that sometimes jumps back may contain the times of
  /// many runs.
  void find_time(SurveyedTable& table) {
    std::optional<std::vector<std::string>> jumping;
    for (const std::vector<std::string>& candidate : time_candidates(table)) {
      if (!take_times(table, stamps_of(candidate))) continue;
      table.time = candidate;
      const Eigen::Index jumps = jumps_back(table.time_s), stands = stands_still(table.time_s);
      if (stands > table.time_s.size() / 2) {
        if (time_problem_.empty())
          time_problem_ = fmt::format("column {}: {} of {} rows repeat the time of the row before",
                                      fmt::join(candidate, " + "), stands, table.time_s.size());
        continue;
      }
      if (jumps == 0) return;
      if (jumps < table.time_s.size() / 10 && !jumping) jumping = candidate;
    }
    if (jumping) {
      table.time = *jumping;
      take_times(table, stamps_of(*jumping));
      return;
    }
    for (const SurveyedChannel& channel : table.channels)
      if (advances_steadily(channel.values) && take_steady(table, channel.name)) return;
    table.time.clear();
    table.time_problem = time_problem_;
    table.form = {};
    table.time_notes.clear();
    table.unset_rows = 0;
    table.origin_ns = 0;
    const Eigen::Index rows = row_count(table);
    table.time_s = Eigen::VectorXd::LinSpaced(rows, 0.0, static_cast<double>(std::max<Eigen::Index>(rows - 1, 0)));
  }

  /// Whether values are a clock or a counter: they rise evenly, or in steps of one, or are seconds since 1970. A run
  /// may start again, and values may be missing.
  static bool counts_up(Eigen::VectorXd v) {
    constexpr double fewest = 10.0;
    v.conservativeResize(std::remove_if(v.begin(), v.end(), [](double x) { return std::isnan(x); }) - v.begin());
    if (v.size() < 2) return false;
    if (rises_evenly(v)) return true;
    const bool since_1970 = v(0) > 9e8 && v == v.array().round().matrix();
    for (Eigen::Index k = 1; k < v.size(); ++k)
      if (v(k) != v(k - 1) && v(k) != v(0) && !(v(k) == v(k - 1) + 1.0 || (since_1970 && v(k) > v(k - 1))))
        return false;
    return v.tail(1)(0) - v(0) >= (since_1970 ? 1.0 : fewest);
  }

  /// Whether the value changes only where the column that separates runs changes, or in the last row, as a mark of the
  /// end does.
  static bool rests_in_runs(const Eigen::VectorXd& values, const SurveyedTable& table) {
    const SurveyedChannel* const run = table.run.empty() ? nullptr : table.find(table.run);
    for (Eigen::Index k = 1, last = 0; k + 1 < values.size(); ++k) {
      if (std::isnan(values(k))) continue;
      const bool changes = values(k) != values(last) && !std::isnan(values(last));
      if (changes && (run == nullptr || !run->is_number() || run->values(k) == run->values(last))) return false;
      last = k;
    }
    return true;
  }

  /// Times increase in even steps of any size; row counters increase in whole numbers.
  static bool advances_steadily(const Eigen::VectorXd& values) {
    return rises_evenly(values) &&
           (values.tail(values.size() - 1).array() - values.head(values.size() - 1).array() != 1.0).any();
  }

  static bool rises_evenly(const Eigen::VectorXd& values) {
    constexpr Eigen::Index fewest = 10;
    if (values.size() < fewest || !values.allFinite()) return false;
    Eigen::VectorXd steps = values.tail(values.size() - 1) - values.head(values.size() - 1);
    if (!(steps.array() > 0.0).all()) return false;
    std::sort(steps.begin(), steps.end());
    const double median = steps(steps.size() / 2);
    const auto near = ((steps.array() > 0.5 * median) && (steps.array() < 2.0 * median)).count();
    return 10 * near > 9 * steps.size();
  }

  /// If the rate of the channel is common for instruments, uses the channel as times.
  bool take_steady(SurveyedTable& table, const std::string& name) {
    constexpr double lowest_hz = 0.01, highest_hz = 20e3;
    if (!take_times(table, stamps_of({name}))) return false;
    const double rate_hz = static_cast<double>(table.time_s.size() - 1) / (table.time_s.tail(1)(0) - table.time_s(0));
    if (!(rate_hz >= lowest_hz && rate_hz <= highest_hz)) return false;
    table.time = {name};
    table.time_guessed = true;
    return true;
  }

  static Eigen::Index row_count(const SurveyedTable& table) {
    for (const SurveyedChannel& channel : table.channels)
      if (channel.is_number()) return channel.values.size();
    return 0;
  }

  /// Returns false if there are fewer than two stamps. Stamps from before the clock was set become missing values.
  static bool take_times(SurveyedTable& table, const Table& read) {
    std::vector<std::int64_t> stamps = read.time_ns;
    if (stamps.size() < 2) return false;
    table.form = read.form;
    table.time_notes = read.notes;
    table.unset_rows = rows_before_clock_was_set(stamps);
    std::fill_n(stamps.begin(), table.unset_rows, missing_stamp);
    table.time_s.resize(std::ssize(stamps));
    table.origin_ns = missing_stamp;
    for (const std::int64_t stamp : stamps)
      if (stamp != missing_stamp && (table.origin_ns == missing_stamp || stamp < table.origin_ns))
        table.origin_ns = stamp;
    for (std::size_t k = 0; k < stamps.size(); ++k)
      table.time_s(static_cast<Eigen::Index>(k)) =
          stamps[k] == missing_stamp ? not_a_number : static_cast<double>(stamps[k] - table.origin_ns) / 1e9;
    return true;
  }

  static void leave_out_unset(SurveyedTable& table) {
    const auto kept = table.time_s.size() - static_cast<Eigen::Index>(table.unset_rows);
    table.time_s = table.time_s.tail(kept).eval();
    for (SurveyedChannel& channel : table.channels)
      if (channel.values.size() > kept) channel.values = channel.values.tail(kept).eval();
  }

  static bool jumps_back(const Eigen::VectorXd& time_s, Eigen::Index k) { return time_s(k) < time_s(k - 1); }

  /// Finds the column that separates runs. Its value must change wherever time jumps back. Without jumps, it must be a
  /// text that changes only at gaps and never returns to an earlier value.
  void find_run(SurveyedTable& table) {
    std::vector<Eigen::Index> jumps;
    for (Eigen::Index k = 1; k < table.time_s.size(); ++k)
      if (jumps_back(table.time_s, k)) jumps.push_back(k);
    for (const bool named : {true, false})
      for (std::size_t i = 0; i < table.channels.size(); ++i) {
        const SurveyedChannel& channel = table.channels[i];
        if (named != names_run(channel.name)) continue;
        const bool found = jumps.empty()         ? changes_at_gaps(i, table.time_s)
                           : channel.is_number() ? separates(channel.values, jumps)
                                                 : named && channel.type == "text";
        if (!found) continue;
        table.run = channel.name;
        return;
      }
  }

  bool changes_at_gaps(std::size_t column, const Eigen::VectorXd& time_s) const {
    const auto* texts = std::get_if<std::vector<std::string>>(&columns_[column]);
    if (texts == nullptr || time_s.size() < 3 || std::ssize(*texts) != time_s.size()) return false;
    const double longest_s = gap_periods * median_period_s(time_s);
    std::vector<std::string> seen{texts->front()};
    for (std::size_t k = 1; k < texts->size(); ++k) {
      const std::string& text = (*texts)[k];
      if (text == seen.back()) continue;
      const auto at = static_cast<Eigen::Index>(k);
      if (!(time_s(at) - time_s(at - 1) > longest_s) || std::find(seen.begin(), seen.end(), text) != seen.end())
        return false;
      seen.push_back(text);
    }
    return seen.size() > 1 && !seen.front().empty();
  }

  static bool separates(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& jumps) {
    Eigen::Index changes = 0;
    for (Eigen::Index k = 1; k < values.size(); ++k) changes += values(k) != values(k - 1);
    return changes <= 2 * std::ssize(jumps) + 2 &&
           std::all_of(jumps.begin(), jumps.end(), [&](Eigen::Index k) { return values(k) != values(k - 1); });
  }

  /// The rows before the first jump back in time.
  static Stream one_run(const SurveyedTable& table, bool runs) {
    Eigen::Index end = std::min<Eigen::Index>(1, table.time_s.size());
    while (end < table.time_s.size() && !(runs && jumps_back(table.time_s, end))) ++end;
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

FormatOptions surveyed_format() { return {.skip_automatic = true}; }

}  // namespace

const SurveyedChannel* SurveyedTable::find(const std::string& channel) const {
  const auto found =
      std::find_if(channels.begin(), channels.end(), [&](const SurveyedChannel& c) { return c.name == channel; });
  return found == channels.end() ? nullptr : &*found;
}

SurveyedFile survey_file(const std::filesystem::path& path) {
  const std::shared_ptr<const TableReader> reader = open_table(path, surveyed_format());
  SurveyedFile file{path, {}, {}};
  const std::vector<TableInfo> tables = reader->tables();
  FileColumns columns = read_columns(*reader, tables, [](const TableInfo& table, const ColumnInfo& column) {
    const std::string named = column.name.substr(0, column.name.find('[')) + "{";  // velocity{left} names velocity[0]
    const auto names = [&](const ColumnInfo& other) { return other.name.starts_with(named); };
    return column.type != "text" && std::ranges::none_of(table.columns, names);  // text is not surveyed further
  });
  file.notes = std::move(columns.notes);
  for (std::string& line : reader->left_out()) file.notes.push_back(std::move(line));
  for (const TableInfo& table : tables) file.skipped = static_cast<std::size_t>(table.skipped);
  for (std::size_t i = 0; i < tables.size(); ++i)
    if (tables[i].type.empty() && tables[i].rows < 10 && tables.size() > 1)
      continue;  // such as the sizes of the arrays beside them
    else if (columns.alternation[i].empty())
      file.tables.push_back(TableSurvey(*reader, i, tables[i], columns.tables[i]).look());
    else
      file.notes.push_back("left out: " + columns.alternation[i]);
  return file;
}

std::vector<std::string> all_columns(const std::filesystem::path& path) {
  std::vector<std::string> names;
  for (const TableInfo& table : open_table(path, surveyed_format())->tables())
    for (const ColumnInfo& column : table.columns) names.push_back(column.name);
  return names;
}

}  // namespace modebank::app
