#include "app/init/survey.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

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
    const bool runs =
        !table.run.empty() || !clock_restarts({stamps_s.begin(), stamps_s.end()}, table.time_notes).empty();
    table.sampling = check_sampling(one_run(table, runs));
    const Eigen::VectorXd run = table.run.empty() ? Eigen::VectorXd() : table.find(table.run)->values;
    for (SurveyedChannel& channel : table.channels) channel.rests = rests_in_runs(channel.values, run);
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
      const bool pair = next != nullptr && channel.counts && channel.check.least > 9e8 && next->check.largest > 5e8 &&
                        next->check.largest < 1e9;  // seconds since 1970 and nanoseconds
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
    for (std::size_t i = 0; i < table.channels.size(); ++i)  // texts that begin with a time, whatever their names
      if (const auto* texts = std::get_if<std::vector<std::string>>(&columns_[i]);
          texts != nullptr && !texts->empty() && is_known_time(texts->front()) && !names_time(table.channels[i].name))
        typed.push_back({table.channels[i].name});
    return typed;
  }

  /// If a text column has times of day, the name of the text column beside it that has dates.
  static std::string date_beside(const SurveyedTable& table, std::size_t time) {
    for (const std::size_t i : {time - 1, time + 1})
      if (i < table.channels.size() && words_of_name(table.channels[i].name).ends_with(" date ") &&
          table.channels[i].type == "text" && table.channels[time].type == "text")
        return table.channels[i].name;
    return {};
  }

  /// Differences of neighbouring values.
  static Eigen::ArrayXd steps_of(const Eigen::VectorXd& values) {
    const Eigen::Index count = std::max<Eigen::Index>(values.size() - 1, 0);
    return values.tail(count) - values.head(count);
  }

  /// Takes the first candidate with increasing times. A candidate that sometimes jumps back may contain the times of
  /// many runs.
  void find_time(SurveyedTable& table) {
    std::optional<std::vector<std::string>> jumping;
    for (const std::vector<std::string>& candidate : time_candidates(table)) {
      if (!take_times(table, stamps_of(candidate))) continue;
      table.time = candidate;
      const Eigen::ArrayXd steps = steps_of(table.time_s);
      const Eigen::Index jumps = (steps < 0.0).count(), stands = (steps == 0.0).count();
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
    Eigen::Index rows = 0;
    for (const SurveyedChannel& channel : table.channels) rows = std::max(rows, channel.values.size());
    table.time_s = Eigen::VectorXd::LinSpaced(rows, 0.0, static_cast<double>(std::max<Eigen::Index>(rows - 1, 0)));
  }

  /// Whether values are a clock or a counter: they rise evenly, or in steps of one, or are seconds since 1970. A run
  /// may start again, and values may be missing.
  static bool counts_up(Eigen::VectorXd v) {
    v.conservativeResize(std::remove_if(v.begin(), v.end(), [](double x) { return std::isnan(x); }) - v.begin());
    if (v.size() < 10 || rises_evenly(v)) return v.size() >= 10;
    const Eigen::ArrayXd now = v.tail(v.size() - 1), step = steps_of(v);
    const double most = v(0) > 9e8 ? HUGE_VAL : 1.0;
    return (now == v(0) || (step == step.abs().round() && step <= most)).all() &&
           v.tail(1)(0) - v(0) >= (most > 1.0 ? 1.0 : 10.0);
  }

  /// Whether the value changes only where the column that separates runs changes, or in the last row, as a mark of the
  /// end does.
  static bool rests_in_runs(const Eigen::VectorXd& values, const Eigen::VectorXd& run) {
    std::unordered_map<double, double> value_of;
    for (Eigen::Index k = 0; k + 1 < values.size(); ++k) {
      const double of = run.size() > 0 ? run(k) : 0.0;
      if (!std::isnan(values(k)) && value_of.try_emplace(of, values(k)).first->second != values(k)) return false;
    }
    return true;
  }

  /// Times increase in even steps of any size; row counters increase in whole numbers.
  static bool advances_steadily(const Eigen::VectorXd& values) {
    return rises_evenly(values) && (steps_of(values) != 1.0).any();
  }

  static bool rises_evenly(const Eigen::VectorXd& values) {
    constexpr Eigen::Index fewest = 10;
    if (values.size() < fewest || !values.allFinite()) return false;
    Eigen::ArrayXd steps = steps_of(values);
    if (!(steps > 0.0).all()) return false;
    std::sort(steps.begin(), steps.end());
    const double median = steps(steps.size() / 2);
    const auto near = (steps > 0.5 * median && steps < 2.0 * median).count();
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

  /// Returns false if there are fewer than two stamps. Stamps from before the clock was set become missing values.
  static bool take_times(SurveyedTable& table, const Table& read) {
    std::vector<std::int64_t> stamps = read.time_ns;
    if (stamps.size() < 2) return false;
    table.form = read.form;
    table.time_notes = read.notes;
    table.unset_rows = rows_before_clock_was_set(stamps);
    std::fill_n(stamps.begin(), table.unset_rows, missing_stamp);
    table.time_s.resize(std::ssize(stamps));
    std::vector<std::int64_t> known = stamps;
    std::erase(known, missing_stamp);
    table.origin_ns = known.empty() ? missing_stamp : *std::ranges::min_element(known);
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
      if (!(time_s(at) - time_s(at - 1) > longest_s) || std::ranges::count(seen, text) > 0) return false;
      seen.push_back(text);
    }
    return seen.size() > 1 && !seen.front().empty();
  }

  static bool separates(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& jumps) {
    return (steps_of(values) != 0.0).count() <= 2 * std::ssize(jumps) + 2 &&
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
