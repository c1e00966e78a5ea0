#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/config/config.hpp"
#include "io/import/import_plan.hpp"
#include "io/table/stamp.hpp"

namespace modebank::app {

/// Lines of a log that come one by one, as rows of the table that import makes of a file with the same lines: the same
/// reader, times and derived channels. CSV has a header or none, and may have a row of units; NDJSON one object per
/// line.
class LineTable {
 public:
  /// `data`: channels, times and formats of the archive.
  explicit LineTable(const DataOptions& data);

  /// Takes a line that comes before the columns are known; is_open() afterwards unless it is a comment. True: it is a
  /// row, which read() has yet to take. Throws ConfigurationError without a needed column, listing those there are.
  bool open(const std::string& line);
  bool is_open() const { return plan_.has_value(); }
  /// Whether lines are JSON objects, each with its names; else they are CSV.
  bool has_objects() const { return format_ == Format::objects; }
  /// A row per line, with derived channels in place; none of the line after the header where that has the columns'
  /// units. Throws std::runtime_error, naming no line, unless every line is a row. One line at a time until the first
  /// row is there.
  Table read(const std::vector<std::string>& lines);
  bool has_rows() const { return !first_row_.empty(); }
  /// Where states, inputs and data.where stand in Table::numbers.
  const FilePlan& plan() const { return *plan_; }
  /// Seconds of a row of the table that was read last; NaN: missing.
  double time_s(const Table& table, std::size_t row) const;
  /// The remainder to add to it: a double of seconds since 1970 lacks nanoseconds.
  double rest_s(const Table& table, std::size_t row) const;
  /// Whether rows have times; else row k is k / data.rate_hz.
  bool has_times() const { return !plan_->sources.front().request.time.column.empty(); }
  /// The first row's time, where the second row has shown that its unit is another than was taken. Once.
  std::optional<double> corrected_first_s() { return std::exchange(corrected_first_s_, std::nullopt); }
  /// The reader's remarks since the last call.
  std::vector<std::string> notes() { return std::exchange(notes_, {}); }
  /// Whether a line without a line break has all its fields.
  bool is_whole(const std::string& line) const;

 private:
  DataOptions data_;
  enum class Format { unknown, csv, objects };
  Format format_ = Format::unknown;   ///< by the first line
  std::string head_;                  ///< of CSV: the lines before the first row, each with its line break
  std::vector<std::string> columns_;  ///< of CSV all, of NDJSON the members that are read
  std::optional<FilePlan> plan_;
  std::string first_row_;                   ///< stays before all others of CSV: they are read as it was
  std::size_t rows_ = 0, rows_before_ = 0;  ///< rows_before_: the table that was read last
  double first_s_ = 0.0;
  std::optional<double> corrected_first_s_;
  bool unit_known_ = false, after_header_ = false;
  std::vector<Expression::Memory> memory_;  ///< per derived channel
  std::optional<std::int64_t> origin_ns_;
  DayCount days_;  ///< of times of day, over all rows so far
  std::vector<std::string> notes_;

  void open_csv();
  bool starts_with_a_row() const;
  void open_json(const std::string& line);
  void plan_for(const TableInfo& table);
  std::vector<std::string> fields_in(const std::string& line) const;
  bool take_units(const std::string& line);
  Table rows_of(const std::vector<std::string>& lines, TimeUnit unit) const;
  Table json_rows(const std::vector<std::string>& lines, const TableRequest& request) const;
  void begin(const std::string& line, const Table& table);
  void learn_unit(const std::vector<std::string>& lines, const Table& table);
  void pass_midnights(Table& table);
  void derive(Table& table);
};

}  // namespace modebank::app
