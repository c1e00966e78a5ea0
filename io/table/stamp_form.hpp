#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/time_unit.hpp"

namespace modebank {

/// Format of a column's stamps, and how it was found.
struct StampForm {
  enum class Ground {
    none,       ///< no stamp was read
    stated,     ///< stated by the user, the format or the column's name
    magnitude,  ///< numbers that count from a known epoch
    spacing,    ///< whole numbers, from their increments
    assumed,    ///< seconds, because nothing indicates another unit
    text        ///< times as text
  };
  Ground ground = Ground::none;
  TimeUnit unit = TimeUnit::s;  ///< for numbers
  std::int64_t first_day = 0;   ///< for days since another epoch: the number of 1970-01-01
  std::vector<std::string> patterns =
      {};  ///< for text: all patterns that fit every value; several if the values are ambiguous
  std::vector<std::string> alike = {};  ///< for text: patterns that read every value like the first of `patterns`
  std::string value = {};               ///< the first stamp, as written
  std::uint64_t line = 0;               ///< line of the first stamp
  bool clock = false;                   ///< whether it is a time of day, counted from midnight
};

/// The format of numbers, from their magnitude and increments together. `values`: NaN where missing. `all_whole`:
/// whether all are whole. Adds remarks for the user to `notes`.
StampForm form_of_numbers(std::string_view column, const std::vector<double>& values, bool all_whole,
                          std::vector<std::string>& notes);

/// Reduces `patterns` and `alike` to those that fit the texts of both files. Returns false, without a change, if no
/// pattern fits both.
bool join_patterns(StampForm& ours, const StampForm& theirs);

/// The number of 1970-01-01 in serial days of this size: of spreadsheets (since 1899-12-30) or of MATLAB (since the
/// year 0). 0: neither.
std::int64_t first_day_of(double serial_day);

}  // namespace modebank
