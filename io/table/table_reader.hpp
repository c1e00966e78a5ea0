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

/// A column of a table. `name` is unique within the file. It is a name in a CSV header, or for example
/// "/imu/data.angular_velocity.z" in a recording.
struct ColumnInfo {
  std::string name;
  std::string unit = {};  ///< the unit; empty if the format states none
  std::string type = {};  ///< the type that the format states; "time": stamps, which are requested as
                          ///< TableRequest::time
};

/// One table of a file. Its columns have the same rows and times. A recording has one table for each topic.
struct TableInfo {
  std::string name;  ///< empty if the file is a single table
  std::string type;  ///< the format's name for a row, such as "sensor_msgs/Imu"; may be empty
  std::vector<ColumnInfo> columns;
  std::uint64_t rows = 0;     ///< 0 if unknown before reading
  std::uint64_t skipped = 0;  ///< number of title lines above the table in a text file
};

/// The columns of times. Empty if no times are requested. If a stamp is in two columns, the second column contains
/// nanoseconds, or the time of day that belongs to a date.
struct TimeRequest {
  std::string column = {};
  std::string second = {};
  TimeUnit unit = TimeUnit::automatic;
  std::string format = {};  ///< a StampPattern; empty: the pattern is found from the stamps
  bool may_miss = false;    ///< true: a missing stamp becomes missing_stamp; false: it is an error
};

/// The requested columns of a table. Other columns are skipped without a check.
struct TableRequest {
  std::size_t table = 0;                ///< index of the table in TableReader::tables
  std::vector<std::string> numbers;     ///< columns of finite numbers; each column occurs once
  std::vector<std::string> texts = {};  ///< columns of text; each column occurs once
  std::vector<bool> may_miss = {};      ///< for each column of numbers, whether missing values become NaN; empty:
                                        ///< missing values are errors
  TimeRequest time = {};
};

/// Rows `first` to `last` of a file, counted in the same way as Table::line.
struct LineRange {
  std::uint64_t first = 0, last = 0;
};

/// Text such as "rows 3 to 7 and 2 more ranges". There must be at least one range.
std::string rows_text(const std::vector<LineRange>& ranges);
/// The range that contains the line. The end iterator if there is none.
std::vector<LineRange>::const_iterator range_of(const std::vector<LineRange>& ranges, std::uint64_t line);
/// Returns "; rows 3 to 7 were never written" if a range contains the line; otherwise an empty text.
std::string unwritten_text(const std::vector<LineRange>& ranges, std::uint64_t line);

inline constexpr std::int64_t missing_stamp = std::numeric_limits<std::int64_t>::min();

struct Table {
  std::vector<std::vector<double>> numbers;     ///< one vector for each requested column, with one value per row
  std::vector<std::vector<std::string>> texts;  ///< one vector for each requested column of texts, without blanks at
                                                ///< their ends
  std::vector<std::uint64_t> line;              ///< line or message number of each row, for messages file:line
  std::vector<std::int64_t> time_ns;            ///< exact time of each row; empty if no times were requested
  /// Stamps that were written as seconds in text, which may be finer than `time_ns`. Empty for all other stamps.
  std::vector<double> time_s;
  std::map<std::string, std::size_t> missing_words;  ///< number of missing values for each word of data.na
  StampForm form = {};                               ///< stamp format, if times were numbers or text
  std::vector<std::string> notes;  ///< remarks of the reader for the user; without the file's name, so that equal
                                   ///< remarks on many files can be merged

  std::vector<LineRange> unwritten;  ///< lines whose times were never written; they contain the file's fill value

  /// A sentence with the key that separates frames, if consecutive rows belong to different frames.
  std::string alternation;

  std::size_t rows() const { return line.size(); }
};

/// The interface between file formats and runs. It gives a file's tables and their values. All other code (plans,
/// joining, lags, gaps, roles) is independent of formats. A new format needs a derived class and an entry in
/// open_table.
class TableReader {
 public:
  virtual ~TableReader() = default;

  /// The tables and their columns. Reads the file only as far as needed. Throws ConfigurationError if the file cannot
  /// be read or has no columns. Throws DataError if the file is malformed.
  virtual std::vector<TableInfo> tables() const = 0;

  /// Describes the file and identifies the requested data: equal data have equal hashes. Throws if the file cannot be
  /// read.
  virtual InputFile describe(const std::vector<TableRequest>& requests) const = 0;

  /// Reads the requested columns in one pass over the file. Returns one table for each request. Sets `file`, unless
  /// null, to the result of `describe`.
  /// Throws the same exceptions as column_position. Throws DataError with file, line and column for text instead of a
  /// number, for a malformed row, and for a missing value (empty, NaN or infinite) in a column without may_miss.
  virtual std::vector<Table> read(const std::vector<TableRequest>& requests, InputFile* file) const = 0;

  /// One line, with advice, for every object of the file that is not a table.
  virtual std::vector<std::string> left_out() const { return {}; }

  /// Reason why a column that a user may expect is missing. Empty if the reason is unknown.
  virtual std::string why_without(const std::string& /*column*/) const { return {}; }
};

std::vector<std::string> column_names(const TableInfo& table);

/// Index of a column. Throws ConfigurationError with `file` if the column occurs twice or is missing. If it is missing,
/// the message lists the existing names and the nearest name.
std::size_t column_position(std::string_view file, const std::vector<std::string>& columns, const std::string& column);

}  // namespace modebank
