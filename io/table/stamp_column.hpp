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

/// A column of stamps, read row by row. The unit of numbers is found at the end. Texts are read by several patterns;
/// only patterns that fit every text remain. All formats use this class, so that all read stamps alike.
class StampColumn {
 public:
  /// `stated_unit`: unit in the format ("ms"), else empty. Throws std::invalid_argument for a request with an invalid
  /// StampPattern.
  StampColumn(const TimeRequest& request, std::string_view stated_unit);

  void reserve(std::size_t rows);
  /// Adds the next row's stamp. Adds nothing unless the result is `ok`.
  NumberStatus add(std::string_view text);
  /// Adds the next row's stamp from two columns: whole seconds and nanoseconds, or a date and a time of day.
  NumberStatus add(std::string_view text, std::string_view second);
  NumberStatus add(double value);
  NumberStatus add(std::int64_t value);
  /// Adds a missing stamp.
  void add_missing();

  /// The end of a message on a text, by the status that `add` returned for it.
  std::string complaint(NumberStatus status, std::string_view text) const;

  /// Finds the format and sets time_ns, time_s, form and notes of `table`, whose lines are set. Throws DataError with
  /// `file` for a stamp that overflows 64 bits of nanoseconds. Call it only once, after all stamps were added.
  void finish(std::string_view file, Table& table);

 private:
  /// The texts so far, read by one pattern.
  struct Reading {
    StampPattern pattern;
    std::vector<Stamp> stamps;
    DayCount days{};  ///< for times of day
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
  std::vector<StampPattern> patterns_;  // one pattern if the user states it, else several
  enum class Kind { unknown, number, text } kind_ = Kind::unknown;
  std::vector<Stamp> stamps_;       // stamps from numbers
  std::vector<double> as_written_;  // NaN: missing
  std::vector<Reading> readings_;   // stamps from texts
  std::string first_value_;
  std::size_t first_row_ = 0;
  bool whole_numbers_ = true;
};

}  // namespace modebank
