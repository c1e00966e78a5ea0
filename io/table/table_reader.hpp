#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/input_file.hpp"
#include "io/table/format_options.hpp"
#include "io/table/stamp_form.hpp"
#include "io/table/time_unit.hpp"

namespace modebank {

/// A column of a table. `name` is unique within the file: a name in a CSV header, or "/imu/data.angular_velocity.z" in
/// a recording.
struct ColumnInfo {
  std::string name;
  std::string unit = {};  ///< unit, if the format states it
  std::string type = {};  ///< type by the format; "time": stamps, to be requested as TableRequest::time
};

/// One table of a file: rows with common times. A recording has one table per topic.
struct TableInfo {
  std::string name;  ///< empty: the file is one table
  std::string type;  ///< the format's word for a row, such as "sensor_msgs/Imu"; may be empty
  std::vector<ColumnInfo> columns;
  std::uint64_t rows = 0;     ///< 0: unknown before reading
  std::uint64_t skipped = 0;  ///< number of title lines above a table of text
};

/// The columns of times; if empty, none are requested. A stamp in two columns has nanoseconds in the second column, or
/// the time of day beside a date.
struct TimeRequest {
  std::string column = {};
  std::string second = {};
  TimeUnit unit = TimeUnit::automatic;
  std::string format = {};  ///< a StampPattern; empty: a pattern is found
  bool may_miss = false;    ///< true: a missing stamp becomes missing_stamp; false: it is an error
};

/// Requested columns of a table. Other columns are skipped without a check.
struct TableRequest {
  std::size_t table = 0;                ///< index in TableReader::tables
  std::vector<std::string> numbers;     ///< columns of finite numbers, each once
  std::vector<std::string> texts = {};  ///< columns of text, each once
  std::vector<bool> may_miss = {};      ///< for each number, whether missing values become NaN; empty: they are errors
  TimeRequest time = {};
};

/// Rows `first` to `last` of a file, as Table::line counts.
struct LineRange {
  std::uint64_t first = 0, last = 0;
};

/// "rows 3 to 7 and 2 more ranges"; needs at least one range.
std::string rows_text(const std::vector<LineRange>& ranges);
/// The range that contains the line; the end if there is none.
std::vector<LineRange>::const_iterator range_of(const std::vector<LineRange>& ranges, std::uint64_t line);
/// "; rows 3 to 7 were never written" if a range contains the line, else empty.
std::string unwritten_text(const std::vector<LineRange>& ranges, std::uint64_t line);

inline constexpr std::int64_t missing_stamp = std::numeric_limits<std::int64_t>::min();

struct Table {
  std::vector<std::vector<double>> numbers;     ///< one vector per requested column, one value per row
  std::vector<std::vector<std::string>> texts;  ///< the same for texts, without blanks around them
  std::vector<std::uint64_t> line;              ///< for each row its line or message number, for messages file:line
  std::vector<std::int64_t> time_ns;            ///< per row, exact; empty when no time was requested
  /// Stamps written as seconds in text, which may be finer than time_ns; else empty.
  std::vector<double> time_s;
  std::map<std::string, std::size_t> missing_words;  ///< number of missing values by word of data.na
  StampForm form = {};                               ///< stamp format, if the times were numbers or text
  std::vector<std::string> notes;  ///< remarks of the reader for the user, without the file's name, so that equal
                                   ///< remarks on many files are merged

  std::vector<LineRange> unwritten;  ///< lines whose times were never written and so have the file's fill value

  /// If consecutive rows belong to different frames, a sentence with the key that separates them.
  std::string alternation;

  std::size_t rows() const { return line.size(); }
};

/// The interface between file formats and runs: a file's tables and their values. All code behind this interface
/// (plans, joining, lags, gaps, roles) is independent of formats. A new format needs a derived class and an entry in
/// open_table.
class TableReader {
 public:
  virtual ~TableReader() = default;

  /// The tables and their columns. Reads only as far as needed. Throws ConfigurationError if the file cannot be read or
  /// has no columns, and DataError if it is malformed.
  virtual std::vector<TableInfo> tables() const = 0;

  /// Identifies the data of these requests: equal data have equal hashes. Throws if the file cannot be read.
  virtual InputFile describe(const std::vector<TableRequest>& requests) const = 0;

  /// Reads the requested columns in one pass over the file, one table per request. Sets `file`, unless null, to the
  /// result of `describe`. Throws as column_position does. Throws DataError with file, line and column for text in
  /// place of a number, for a malformed row, and for a missing value (empty, NaN or infinite) in a column without
  /// may_miss.
  virtual std::vector<Table> read(const std::vector<TableRequest>& requests, InputFile* file) const = 0;

  /// One line, with advice, for every object of the file that is not a table.
  virtual std::vector<std::string> left_out() const { return {}; }

  /// Reason why a column that a user may expect is missing; empty if unknown.
  virtual std::string why_without(const std::string& /*column*/) const { return {}; }
};

std::vector<std::string> column_names(const TableInfo& table);

/// Index of a column. Throws ConfigurationError with `file` if the column is missing (with the existing names and the
/// nearest one) or occurs twice.
std::size_t column_position(std::string_view file, const std::vector<std::string>& columns, const std::string& column);

}  // namespace modebank
