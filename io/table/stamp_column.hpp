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

/// A column of stamps, taken row by row as a file has them: numbers whose unit is found once all are there, or times as
/// text, by every pattern that fits all of them. Every reader's stamps go through it, so that they are read one way.
class StampColumn {
 public:
  /// `stated_unit`: where the format says it ("ms"), else empty. Throws std::invalid_argument for a request whose
  /// format is no StampPattern.
  StampColumn(const TimeRequest& request, std::string_view stated_unit);

  void reserve(std::size_t rows);
  /// The next row's stamp; nothing is added unless it is `ok`.
  NumberStatus add(std::string_view text);
  /// The next row's stamp in two columns: whole seconds and nanoseconds, or a date and a time of day.
  NumberStatus add(std::string_view text, std::string_view second);
  NumberStatus add(double value);
  NumberStatus add(std::int64_t value);
  /// The next row's stamp is missing.
  void add_missing();

  /// The ending of a message about a text that `add` gave this status for.
  std::string complaint(NumberStatus status, std::string_view text) const;

  /// Decides on the form and fills time_ns, time_s, form and notes of `table`, whose lines are there. Throws DataError,
  /// naming `file`, for a stamp that no 64 bits of nanoseconds hold. Once, as the last call.
  void finish(std::string_view file, Table& table);

 private:
  /// The text so far by one pattern.
  struct Reading {
    StampPattern pattern;
    std::vector<Stamp> stamps;
    DayCount days{};  ///< of times of day
    bool fits = true;

    void push(Stamp stamp);
    /// Whether the stamps advance in steps without a gap.
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
  std::vector<StampPattern> patterns_;  // one where the user states it, else none
  enum class Kind { unknown, number, text } kind_ = Kind::unknown;
  std::vector<Stamp> stamps_;       // of numbers
  std::vector<double> as_written_;  // NaN: missing
  std::vector<Reading> readings_;   // of text
  std::string first_value_;
  std::size_t first_row_ = 0;
  bool whole_numbers_ = true;
};

}  // namespace modebank
