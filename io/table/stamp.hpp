#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace modebank {

inline constexpr std::int64_t billion = 1'000'000'000;

/// A stamp as written: a whole number of units, and billionths of a unit from 0 to 999,999,999.
struct Stamp {
  std::int64_t whole = 0;
  std::int32_t billionths = 0;

  bool operator==(const Stamp&) const = default;
};

/// The digits of a fraction in billionths, rounded; at most one billion.
std::int64_t billionths_of(std::string_view digits);

/// Carries negative billionths, or one billion, over to the whole number; |billionths| is at most one billion.
Stamp normalised_stamp(std::int64_t whole, std::int64_t billionths);

/// A decimal number without exponent, with at most 18 digits before its point; digits beyond a billionth are rounded.
/// Blanks around it are allowed. Nullopt for other texts.
std::optional<Stamp> parse_decimal_stamp(std::string_view text);

/// The stamp of a finite number with a magnitude below 9.2e18.
Stamp stamp_of(double value);

/// Converts times of day that continue past midnight, in the order of a log.
class DayCount {
 public:
  /// Seconds since the midnight before the first time. A time of day that is hours earlier than the last one belongs to
  /// the next day. After midnight, a time of day that is nearly a day later is a late row of the previous day.
  std::int64_t on(std::int64_t time_of_day_s);

 private:
  std::int64_t days_ = 0;
  std::optional<std::int64_t> latest_;
};

/// Exact seconds as text: "1700000000.02".
std::string seconds_text(std::int64_t time_ns);

/// UTC as text: "2024-05-01T10:00:00.250Z".
std::string iso_text(std::int64_t time_ns);

}  // namespace modebank
