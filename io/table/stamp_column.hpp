#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/number.hpp"
#include "io/table/stamp.hpp"
#include "io/table/stamp_pattern.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// A column of stamps, which is read row by row. All formats use this class, so all read stamps in the same way. The
/// unit of numbers is found at the end. Texts are tried with several patterns; a pattern that does not fit a text is
/// dropped.
class StampColumn {
 public:
  /// `stated_unit`: the unit that the format states ("ms"); empty if it states none. Throws std::invalid_argument if
  /// the request has an invalid StampPattern.
  StampColumn(const TimeRequest& request, std::string_view stated_unit);

  void reserve(std::size_t rows);
  /// Adds the stamp of the next row. If the result is not `ok`, nothing was added.
  NumberStatus add(std::string_view text);
  /// Adds the stamp of the next row from two columns. These are whole seconds and nanoseconds, or a date and a time of
  /// day.
  NumberStatus add(std::string_view text, std::string_view second);
  NumberStatus add(double value);
  NumberStatus add(std::int64_t value);
  /// Adds a missing stamp.
  void add_missing();

  /// Text that completes a message about a stamp, given the status that `add` returned.
  std::string complaint(NumberStatus status, std::string_view text) const;

  /// Finds the format. Sets `time_ns`, `time_s`, `form` and `notes` of `table`; `table` must already contain lines.
  /// Throws DataError with `file` if a stamp overflows 64 bits of nanoseconds. Call this function only once, after all
  /// stamps were added.
  void finish(std::string_view file, Table& table);

 private:
  /// All texts so far, converted by one pattern.
  struct Reading {
    StampPattern pattern;
    std::vector<Stamp> stamps;
    DayCount days{};  ///< used for times of day
    bool fits = true;

    void push(Stamp stamp);
    /// Whether the stamps advance without a gap.
    bool is_even(const std::vector<double>& missing) const;
  };

  void push(Stamp stamp, double as_written);
  NumberStatus add_by_patterns(std::string_view text);
  bool start_readings(std::string_view text);
  StampForm found_form(std::vector<std::string>& notes) const;
  void decide_reading(Table& table);
  std::int64_t nanoseconds(std::size_t row, const StampForm& form) const;

  TimeRequest request_;
  std::string stated_unit_;
  std::vector<StampPattern> patterns_;  // one pattern if the user states one, otherwise several
  enum class Kind { unknown, number, text } kind_ = Kind::unknown;
  std::vector<Stamp> stamps_;       // stamps that are numbers
  std::vector<double> as_written_;  // NaN: missing
  std::vector<Reading> readings_;   // stamps that are texts
  std::string first_value_;
  std::size_t first_row_ = 0;
  bool whole_numbers_ = true;
};

}  // namespace modebank
