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

/// A column of a table. `name` is unique within the file: a CSV header's, or "/imu/data.angular_velocity.z" of a
/// recording.
struct ColumnInfo {
  std::string name;
  std::string unit = {};  ///< where the format says so
  std::string type = {};  ///< the format's word for it; "time": stamps, to be asked for as TableRequest::time
};

/// One table of a file: rows that share their times. A recording has one per topic.
struct TableInfo {
  std::string name;  ///< empty: the file is one table
  std::string type;  ///< the format's word for a row, as "sensor_msgs/Imu"; may be empty
  std::vector<ColumnInfo> columns;
  std::uint64_t rows = 0;     ///< 0: not known without reading
  std::uint64_t skipped = 0;  ///< lines of a title above it, in text
};

/// The column of times; an empty one asks for none. Stamps in two columns have their nanoseconds in the second, or the
/// time of day beside a date.
struct TimeRequest {
  std::string column = {};
  std::string second = {};
  TimeUnit unit = TimeUnit::automatic;
  std::string format = {};  ///< a StampPattern; empty: found
  bool may_miss = false;    ///< whether a missing stamp becomes missing_stamp; else it is an error
};

/// Which columns of a table are wanted; the others are skipped unread and may hold anything.
struct TableRequest {
  std::size_t table = 0;                ///< position in TableReader::tables
  std::vector<std::string> numbers;     ///< columns of finite numbers, each once
  std::vector<std::string> texts = {};  ///< columns of text, each once
  std::vector<bool> may_miss = {};      ///< per number: whether missing values become NaN; empty: they are errors
  TimeRequest time = {};
};

/// Rows `first` to `last` of a file, as Table::line counts.
struct LineRange {
  std::uint64_t first = 0, last = 0;
};

/// "rows 3 to 7 and 2 more ranges"; of one range at least.
std::string rows_text(const std::vector<LineRange>& ranges);
/// The range that holds the line, or the end.
std::vector<LineRange>::const_iterator range_of(const std::vector<LineRange>& ranges, std::uint64_t line);
/// "; rows 3 to 7 were never written" where a range holds the line, else empty.
std::string unwritten_text(const std::vector<LineRange>& ranges, std::uint64_t line);

inline constexpr std::int64_t missing_stamp = std::numeric_limits<std::int64_t>::min();

struct Table {
  std::vector<std::vector<double>> numbers;     ///< one vector per requested column, one value per row
  std::vector<std::vector<std::string>> texts;  ///< the same for text, without blanks around
  std::vector<std::uint64_t> line;              ///< per row, where it stands (messages say file:line): line or message
  std::vector<std::int64_t> time_ns;            ///< per row, exact; empty when no time was requested
  /// The same times as they were written, where that is seconds in text, which may be finer; else empty.
  std::vector<double> time_s;
  std::map<std::string, std::size_t> missing_words;  ///< how often each word of data.na stands for a missing number
  StampForm form = {};                               ///< of the times, where they were found in numbers or text
  std::vector<std::string> notes;  ///< what the reader found out and the user should know; without the file's name, so
                                   ///< that many files say it once

  std::vector<LineRange> unwritten;  ///< lines whose times the file declares and never got: they read as a fill value

  /// In words, where rows that follow one another are of different frames, and the key that takes them apart.
  std::string alternation;

  std::size_t rows() const { return line.size(); }
};

/// The one seam between files and runs: how a format tells its tables and gives their values. Everything behind it
/// (plans, joining, lags, gaps, roles) knows tables alone. A new format derives a class and is named in open_table.
class TableReader {
 public:
  virtual ~TableReader() = default;

  /// The tables and their columns, read only as far as needed. Throws ConfigurationError when the file cannot be read
  /// or has no columns, DataError when they are malformed.
  virtual std::vector<TableInfo> tables() const = 0;

  /// What identifies the data that `read` gives for these requests: equal data have equal hashes. Throws when it cannot
  /// be read.
  virtual InputFile describe(const std::vector<TableRequest>& requests) const = 0;

  /// Reads what is wanted, one table per request, in one pass over the file; `file` becomes what `describe` says of it,
  /// unless it is null. Throws as
  /// column_position does, and DataError, naming file, line and column, for text where a number is wanted, a missing
  /// value (empty, NaN or infinite) in a column that may not miss any and a malformed row.
  virtual std::vector<Table> read(const std::vector<TableRequest>& requests, InputFile* file) const = 0;

  /// A line for everything that the file holds and no table gives, saying what helps.
  virtual std::vector<std::string> left_out() const { return {}; }

  /// Why a column that a user may expect is not there; empty when there is nothing to say.
  virtual std::string why_without(const std::string& /*column*/) const { return {}; }
};

std::vector<std::string> column_names(const TableInfo& table);

/// Position of a column. Throws ConfigurationError, naming `file`, when it is missing (listing those that exist and the
/// nearest name) or there twice.
std::size_t column_position(std::string_view file, const std::vector<std::string>& columns, const std::string& column);

}  // namespace modebank
