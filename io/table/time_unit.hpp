#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "modebank/base/names.hpp"

namespace modebank {

/// Unit of a column of times. With `automatic`, the unit follows from the format, from the column's name or unit, or
/// from the magnitude and increments of the stamps.
enum class TimeUnit { automatic, s, ms, us, ns, min, h, d };

template <>
struct EnumNames<TimeUnit> {
  static constexpr Names<8> values{"auto", "s", "ms", "us", "ns", "min", "h", "d"};
};

/// Nanoseconds per unit. `automatic` counts as seconds.
std::int64_t ns_per(TimeUnit unit);

/// Name of a unit, for example "milliseconds".
std::string_view in_words(TimeUnit unit);

/// The unit that a format states as text: "ms", "[h]", "seconds since 1970-01-01". Nullopt if the unit is unknown.
std::optional<TimeUnit> stated_time_unit(std::string_view stated);

/// The unit at the end of a column's name: time_ms, "stamp [us]", TimeUS, timeMs, "Time [h]", hours. Nullopt if the
/// name has no unit.
std::optional<TimeUnit> named_time_unit(std::string_view name);

}  // namespace modebank
