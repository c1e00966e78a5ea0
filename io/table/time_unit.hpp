#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "modebank/base/names.hpp"

namespace modebank {

/// What a column of times counts. automatic: told by the format, by the column's name or unit, or by how large and how
/// far apart the stamps are.
enum class TimeUnit { automatic, s, ms, us, ns, min, h, d };

template <>
struct EnumNames<TimeUnit> {
  static constexpr Names<8> values{"auto", "s", "ms", "us", "ns", "min", "h", "d"};
};

/// Nanoseconds in one of the unit; of seconds for automatic.
std::int64_t ns_per(TimeUnit unit);

/// "milliseconds".
std::string_view in_words(TimeUnit unit);

/// The unit that a format states: "ms", "[h]", "seconds since 1970-01-01". Empty: no known unit of time.
std::optional<TimeUnit> stated_time_unit(std::string_view stated);

/// The unit that a column's name ends in: time_ms, "stamp [us]", TimeUS, timeMs, "Time [h]", hours. Empty: in none.
std::optional<TimeUnit> named_time_unit(std::string_view name);

}  // namespace modebank
