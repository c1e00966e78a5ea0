#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/config/config.hpp"
#include "io/import/import_plan.hpp"
#include "io/table/stamp.hpp"

namespace modebank::app {

/// Lines of a log that arrive one by one: CSV, which may have a header and a row of units, or NDJSON. They become the
/// same rows as in the import of a file with these lines, because reader, times and derived channels are the same code.
class LineTable {
 public:
  /// `data`: channels, times and formats of the archive.
  explicit LineTable(const DataOptions& data);

  /// Takes lines until the columns are known; is_open() is then true. Returns true if the line is a row, which must
  /// then be passed to read(). Throws ConfigurationError with the existing columns if a needed column is missing.
  bool open(const std::string& line);
  bool is_open() const { return plan_.has_value(); }
  /// True if lines are JSON objects, false if they are CSV.
  bool has_objects() const { return format_ == Format::objects; }
  /// Returns one row per line, with derived channels. A line of units after the header gives no row. Throws
  /// std::runtime_error without a line number if a line is not a row. Pass one line at a time until the first row.
  Table read(std::span<const std::string> lines);
  bool has_rows() const { return !first_row_.empty(); }
  /// Positions of the columns of states, inputs and data.where in Table::numbers.
  const FilePlan& plan() const { return *plan_; }
  /// Time of a row in the last table [s]; NaN if it is missing.
  double time_s(const Table& table, std::size_t row) const;
  /// Part of the time that time_s lost by rounding: a double of seconds since 1970 cannot hold nanoseconds.
  double rest_s(const Table& table, std::size_t row) const;
  /// Whether rows have times. Otherwise the time of row k is k / data.rate_hz.
  bool has_times() const { return !plan_->sources.front().request.time.column.empty(); }
  /// The corrected time of the first row, if the second row shows that the unit was wrong. Returned only once.
  std::optional<double> corrected_first_s() { return std::exchange(corrected_first_s_, std::nullopt); }
  /// Remarks of the reader since the last call.
  std::vector<std::string> notes() { return std::exchange(notes_, {}); }
  /// Whether a line without a final newline is complete.
  bool is_whole(const std::string& line) const;

 private:
  DataOptions data_;
  enum class Format { unknown, csv, objects };
  Format format_ = Format::unknown;   ///< format of the stream, from its first line
  std::string head_;                  ///< for CSV: the lines before the first row, with their line breaks
  std::vector<std::string> columns_;  ///< for CSV all columns; for NDJSON only the members that the program reads
  std::optional<FilePlan> plan_;
  std::string first_row_;                   ///< precedes later CSV rows, so that the reader finds the same format
  std::size_t rows_ = 0, rows_before_ = 0;  ///< rows_before_: number of rows before the last read
  double first_s_ = 0.0;
  std::optional<double> corrected_first_s_;
  bool unit_known_ = false, after_header_ = false;
  std::vector<Expression::Memory> memory_;  ///< one per derived channel
  std::optional<std::int64_t> origin_ns_;
  DayCount days_;  ///< counts days of times of day, over all rows so far
  std::vector<std::string> notes_;

  void open_csv();
  bool starts_with_a_row() const;
  void open_json(const std::string& line);
  void plan_for(const TableInfo& table);
  std::vector<std::string> fields_in(const std::string& line) const;
  bool take_units(const std::string& line);
  Table rows_of(std::span<const std::string> lines, TimeUnit unit) const;
  Table json_rows(std::span<const std::string> lines, const TableRequest& request) const;
  void begin(const std::string& line, const Table& table);
  void learn_unit(std::span<const std::string> lines, const Table& table);
  void pass_midnights(Table& table);
  void derive(Table& table);
};

}  // namespace modebank::app
