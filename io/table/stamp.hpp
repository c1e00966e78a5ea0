#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace modebank {

/// A stamp as it is written: whole units (of whatever it counts) and billionths of one, 0 to 999,999,999.
struct Stamp {
  std::int64_t whole = 0;
  std::int32_t billionths = 0;

  bool operator==(const Stamp&) const = default;
};

/// A decimal number without exponent, of at most 18 digits before its point; what is finer than a billionth is rounded.
/// Blanks around it are tolerated. Empty for anything else.
std::optional<Stamp> parse_decimal_stamp(std::string_view text);

/// Of a finite number whose magnitude is below 9.2e18.
Stamp stamp_of(double value);

/// Seconds since 1970 of an ISO 8601 time: 2024-05-01T10:00:00.25Z. A blank may stand for the T, a comma for the point;
/// seconds may be missing; without a zone (Z, +02:00, +0200, +02) UTC is meant. Empty for anything else.
std::optional<Stamp> parse_iso_time(std::string_view text);

/// Seconds as text, exact: "1700000000.02".
std::string seconds_text(std::int64_t time_ns);

/// "2024-05-01T10:00:00.250Z".
std::string iso_text(std::int64_t time_ns);

}  // namespace modebank
