#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/number.hpp"
#include "io/table/stamp.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// A column of stamps, taken row by row as a file has them: numbers whose unit is found once all are there, or ISO 8601
/// times. Every reader's numbers go through it, so that units are found one way.
class StampColumn {
 public:
  /// `stated_unit`: where the format says it ("ms"), else empty.
  StampColumn(const TimeRequest& request, std::string_view stated_unit);

  void reserve(std::size_t rows);
  /// The next row's stamp as text; nothing is added unless it is `ok`.
  NumberStatus add(std::string_view text);
  void add(double value);  ///< not finite: missing
  void add(std::int64_t value);
  /// The next row's stamp is missing.
  void add_missing();
  /// The nanoseconds of the row that was added last. False: they are none.
  bool add_nanoseconds(std::string_view text);

  /// Decides on the unit and fills time_ns, time_s and notes of `table`, whose lines are there. Throws DataError,
  /// naming `file`, for a stamp that no 64 bits of nanoseconds hold. Once, as the last call.
  void finish(std::string_view file, Table& table);

 private:
  void push(Stamp stamp, double as_written);
  TimeUnit found_unit(std::vector<std::string>& notes) const;
  TimeUnit unit_of_numbers(std::vector<std::string>& notes) const;

  TimeRequest request_;
  std::string stated_unit_;
  enum class Kind { unknown, number, iso } kind_ = Kind::unknown;
  std::vector<Stamp> stamps_;
  std::vector<double> as_written_;  // NaN: missing
  bool whole_numbers_ = true;
};

}  // namespace modebank
