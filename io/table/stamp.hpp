#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace modebank {

inline constexpr std::int64_t billion = 1'000'000'000;

/// A stamp as it is written: whole units (of whatever it counts) and billionths of one, 0 to 999,999,999.
struct Stamp {
  std::int64_t whole = 0;
  std::int32_t billionths = 0;

  bool operator==(const Stamp&) const = default;
};

/// A fraction's digits as billionths, rounded: one billion at most.
std::int64_t billionths_of(std::string_view digits);

/// Carries one billion and negative billionths over to the whole; |billionths| at most one billion.
Stamp normalised_stamp(std::int64_t whole, std::int64_t billionths);

/// A decimal number without exponent, of at most 18 digits before its point; what is finer than a billionth is rounded.
/// Blanks around it are tolerated. Empty for anything else.
std::optional<Stamp> parse_decimal_stamp(std::string_view text);

/// Of a finite number whose magnitude is below 9.2e18.
Stamp stamp_of(double value);

/// Times of day that go on past midnight, taken in the order of a log.
class DayCount {
 public:
  /// Seconds since the midnight before the first. A time of day that falls by hours belongs to the next day; one that
  /// rises by nearly a day, once midnight has passed, to a row of the day before that came late.
  std::int64_t on(std::int64_t time_of_day_s);

 private:
  std::int64_t days_ = 0;
  std::optional<std::int64_t> latest_;
};

/// Seconds as text, exact: "1700000000.02".
std::string seconds_text(std::int64_t time_ns);

/// "2024-05-01T10:00:00.250Z".
std::string iso_text(std::int64_t time_ns);

}  // namespace modebank
