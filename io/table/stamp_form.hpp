#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/time_unit.hpp"

namespace modebank {

/// How a column writes its stamps, and what shows it.
struct StampForm {
  enum class Ground {
    none,       ///< no stamp was read
    stated,     ///< by the user, the format or the column's name
    magnitude,  ///< numbers that count from an epoch
    spacing,    ///< whole numbers, by how far apart they are
    assumed,    ///< seconds for want of anything else
    text        ///< times as text
  };
  Ground ground = Ground::none;
  TimeUnit unit = TimeUnit::s;             ///< of numbers
  std::int64_t first_day = 0;              ///< of days: the number of 1970-01-01 where they count from another epoch
  std::vector<std::string> patterns = {};  ///< of text: all that fit every value; several: the values do not tell which
  std::vector<std::string> alike = {};     ///< of text: others that read every value as the first of `patterns` does
  std::string value = {};                  ///< the first stamp, as it is written
  std::uint64_t line = 0;                  ///< where it stands
  bool clock = false;                      ///< whether it is a time of day, which counts from midnight
};

/// The form of numbers, found by magnitude and spacing together. `values`: NaN where missing.
/// `all_whole`: of all of them. What the user should know is added to `notes`.
StampForm form_of_numbers(std::string_view column, const std::vector<double>& values, bool all_whole,
                          std::vector<std::string>& notes);

/// Makes `patterns` and `alike` of one file's texts those of two files. False: no pattern fits both, and all stays.
bool join_patterns(StampForm& ours, const StampForm& theirs);

/// The number of 1970-01-01 in serial days of this size: those of spreadsheets (since 1899-12-30) and of MATLAB (since
/// the year 0). 0: others.
std::int64_t first_day_of(double serial_day);

}  // namespace modebank
