#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace modebank {

inline constexpr std::int64_t billion = 1'000'000'000;

/// A stamp as it is written: a whole number of units, plus billionths of a unit (0 to 999,999,999).
struct Stamp {
  std::int64_t whole = 0;
  std::int32_t billionths = 0;

  bool operator==(const Stamp&) const = default;
};

/// Converts the digits of a fraction to billionths, rounded. The result is at most one billion.
std::int64_t billionths_of(std::string_view digits);

/// Carries negative billionths, or one billion, over to the whole number. |billionths| must be at most one billion.
Stamp normalised_stamp(std::int64_t whole, std::int64_t billionths);

/// Parses a decimal number without exponent and with at most 18 digits before its point. The fraction is rounded to
/// billionths. Blanks around the number are allowed. Nullopt for any other text.
std::optional<Stamp> parse_decimal_stamp(std::string_view text);

/// Converts a finite number whose magnitude is below 9.2e18.
Stamp stamp_of(double value);

/// Converts times of day in the order of a log. The log may continue past midnight.
class DayCount {
 public:
  /// Seconds since the midnight before the first time. If a time of day is hours earlier than the last one, it belongs
  /// to the next day. If it is then nearly a day later than the last one, it is a late row of the previous day.
  std::int64_t on(std::int64_t time_of_day_s);

 private:
  std::int64_t days_ = 0;
  std::optional<std::int64_t> latest_;
};

/// Exact seconds as text, for example "1700000000.02".
std::string seconds_text(std::int64_t time_ns);

/// UTC as text, for example "2024-05-01T10:00:00.250Z".
std::string iso_text(std::int64_t time_ns);

}  // namespace modebank
