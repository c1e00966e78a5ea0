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
    stated,     ///< the user, the format or the column's name states the format
    magnitude,  ///< the numbers count from a known epoch
    spacing,    ///< the numbers are whole, and their increments indicate the unit
    assumed,    ///< seconds, because nothing indicates another unit
    text        ///< times as text
  };
  Ground ground = Ground::none;
  TimeUnit unit = TimeUnit::s;  ///< for numbers
  std::int64_t first_day = 0;   ///< for days since another epoch: the number that means 1970-01-01
  std::vector<std::string> patterns =
      {};  ///< for text: all patterns that fit every value; several if the values are ambiguous
  std::vector<std::string> alike = {};  ///< for text: patterns that give the same times as the first of `patterns`
  std::string value = {};               ///< the first stamp, as it is written
  std::uint64_t line = 0;               ///< line of the first stamp
  bool clock = false;                   ///< whether the stamp is a time of day, counted from midnight
};

/// The upper of two middle values for an even count; 0 if empty.
double upper_median(std::vector<double> values);

/// The format of numbers, found from their magnitude and their increments. `values`: NaN means missing. `all_whole`:
/// whether all numbers are whole. Adds remarks for the user to `notes`.
StampForm form_of_numbers(std::string_view column, const std::vector<double>& values, bool all_whole,
                          std::vector<std::string>& notes);

/// Reduces `patterns` and `alike` to the patterns that fit the texts of both files. If no pattern fits both, changes
/// nothing and returns false.
bool join_patterns(StampForm& ours, const StampForm& theirs);

/// The number that means 1970-01-01 in serial days. Serial days are those of spreadsheets (since 1899-12-30) or of
/// MATLAB (since the year 0); the size of `days` decides. 0 if the size fits neither.
std::int64_t first_day_of(double serial_day);

}  // namespace modebank
