#include "io/table/stamp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

#include "ident/base/characters.hpp"
#include "io/table/number.hpp"

namespace modebank {

namespace {

/// Removes leading digits from `text` and returns them. Nullopt if there are none.
std::optional<std::string_view> take_digits(std::string_view& text) {
  std::size_t count = 0;
  while (count < text.size() && is_digit(text[count])) ++count;
  if (count == 0) return std::nullopt;
  const std::string_view digits = text.substr(0, count);
  text.remove_prefix(count);
  return digits;
}

bool take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::int64_t billionths_of(std::string_view digits) {
  std::int64_t value = 0;
  for (std::size_t i = 0; i < 9; ++i) value = 10 * value + (i < digits.size() ? digits[i] - '0' : 0);
  return value + (digits.size() > 9 && digits[9] >= '5' ? 1 : 0);
}

Stamp normalised_stamp(std::int64_t whole, std::int64_t billionths) {
  if (billionths >= billion) return {whole + 1, static_cast<std::int32_t>(billionths - billion)};
  if (billionths < 0) return {whole - 1, static_cast<std::int32_t>(billionths + billion)};
  return {whole, static_cast<std::int32_t>(billionths)};
}

std::optional<Stamp> parse_decimal_stamp(std::string_view text) {
  text = without_blanks(text);
  const bool negative = !text.empty() && text.front() == '-';
  take(text, "+-");
  std::string_view whole, fraction;
  if (const auto digits = take_digits(text)) whole = *digits;
  if (take(text, "."))
    if (const auto digits = take_digits(text)) fraction = *digits;
  constexpr std::size_t most_digits = 19;
  if (!text.empty() || (whole.empty() && fraction.empty()) || whole.size() > most_digits) return std::nullopt;
  std::int64_t value = 0;
  if (!whole.empty() && std::from_chars(whole.data(), whole.data() + whole.size(), value).ec != std::errc())
    return std::nullopt;
  const std::int64_t billionths = billionths_of(fraction);
  return negative ? normalised_stamp(-value, -billionths) : normalised_stamp(value, billionths);
}

Stamp stamp_of(double value) {
  const double whole = std::floor(value);
  return normalised_stamp(static_cast<std::int64_t>(whole),
                          std::llround((value - whole) * static_cast<double>(billion)));
}

std::int64_t DayCount::on(std::int64_t time_of_day_s) {
  constexpr std::int64_t day_s = 86400, most_disorder_s = 7200;
  std::int64_t time_s = time_of_day_s + day_s * days_;
  if (latest_ && time_s < *latest_ - most_disorder_s) {
    ++days_;
    time_s += day_s;
  } else if (days_ > 0 && time_s > *latest_ + day_s - most_disorder_s) {
    time_s -= day_s;
  }
  latest_ = latest_ ? std::max(*latest_, time_s) : time_s;
  return time_s;
}

std::string seconds_text(std::int64_t time_ns) {
  const std::int64_t whole = time_ns / billion, rest = time_ns % billion;
  std::string text = fmt::format("{}{}.{:09}", time_ns < 0 && whole == 0 ? "-" : "", whole, std::abs(rest));
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string iso_text(std::int64_t time_ns) {
  using namespace std::chrono;
  const sys_time<nanoseconds> time{nanoseconds(time_ns)};
  const auto day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss clock(floor<milliseconds>(time - day));
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count(), clock.subseconds().count());
}

}  // namespace modebank
