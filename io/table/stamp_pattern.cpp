#include "io/table/stamp_pattern.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <clocale>
#include <ctime>
#include <stdexcept>

#include "ident/base/characters.hpp"
#include "io/table/number.hpp"

namespace modebank {

namespace {

constexpr int seconds_per_day = 86400;

/// The C locale is set here, because the program that uses this library may have set another locale.
locale_t c_locale() {
  static const locale_t locale = newlocale(LC_ALL_MASK, "C", nullptr);
  return locale;
}

/// The text that follows the matching part. Null if nothing matches.
const char* parse(const char* text, const std::string& pattern, tm& time) {
  return strptime_l(text, pattern.c_str(), &time, c_locale());
}

bool has_letter(std::string_view pattern, std::string_view letters) {
  for (std::size_t i = 0; i + 1 < pattern.size(); ++i)
    if (pattern[i] == '%' && letters.find(pattern[++i]) != std::string_view::npos) return true;
  return false;
}

void check_letters(std::string_view pattern) {
  constexpr std::string_view known = "aAbBdDeFfhHIjmMnpRStTyYzZ%";
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] != '%') continue;
    const std::string_view letter = pattern.substr(++i, 1);
    if (letter.empty() || known.find(letter) == std::string_view::npos)
      throw std::invalid_argument(
          fmt::format("has no letter %{} (%Y %m %d %H %M %S, %f for the fraction of a second; see strptime)", letter));
  }
  if (!has_letter(pattern, "HIMSTRdDFej"))
    throw std::invalid_argument("names no part of a time (as %H:%M:%S or %d.%m.%Y %H:%M:%S does)");
}

/// Seconds since 1970, or since midnight. Nullopt if the day is impossible, or the year is too large for 64 bits of
/// nanoseconds.
std::optional<std::int64_t> seconds_of(const tm& time, bool has_date) {
  constexpr int first_year = 1678, last_year = 2261;
  std::int64_t days = 0;
  if (has_date) {
    const int year = time.tm_year + 1900;
    const std::chrono::year_month_day date{std::chrono::year(year),
                                           std::chrono::month(static_cast<unsigned>(time.tm_mon + 1)),
                                           std::chrono::day(static_cast<unsigned>(time.tm_mday))};
    if (!date.ok() || year < first_year || year > last_year) return std::nullopt;
    days = std::chrono::sys_days(date).time_since_epoch().count();
  }
  constexpr int leap_second = 60;
  if (time.tm_sec > leap_second) return std::nullopt;
  return seconds_per_day * days + 3600 * time.tm_hour + 60 * time.tm_min + time.tm_sec - time.tm_gmtoff;
}

/// Removes whole days from the hours of an elapsed time. 26:10:00 becomes 02:10:00 plus one day.
std::int64_t take_days(std::string& text) {
  int hours = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), hours);
  constexpr int day_h = 24, most_hours = 99'999;
  if (error != std::errc() || hours < day_h || hours > most_hours || stop == text.data() + text.size() || *stop != ':')
    return 0;
  text.replace(0, static_cast<std::size_t>(stop - text.data()), fmt::to_string(hours % day_h));
  return hours / day_h;
}

}  // namespace

StampPattern::StampPattern(std::string text) : text_(std::move(text)), has_date_(has_letter(text_, "YyDFjdbBhme")) {
  check_letters(text_);
  const std::size_t at = text_.find("%f");
  fraction_ = at != std::string::npos;
  if (fraction_ && text_.find("%f", at + 1) != std::string::npos) throw std::invalid_argument("has %f twice");
  head_ = text_.substr(0, at);
  if (fraction_) tail_ = text_.substr(at + 2);
  if (!fraction_ && head_.ends_with("%z")) {
    tail_ = "%z";
    head_.resize(head_.size() - tail_.size());
  }
  may_lack_fraction_ = fraction_ && !head_.empty() && (head_.back() == '.' || head_.back() == ',');
  if (may_lack_fraction_) head_.pop_back();
}

std::optional<Stamp> StampPattern::read(std::string_view value) const {
  std::string text(without_blanks(value));
  constexpr std::size_t longest = 64;
  if (text.empty() || text.size() > longest) return std::nullopt;
  const std::int64_t days = !has_date_ && text_.starts_with("%H") ? take_days(text) : 0;
  tm time{};
  const char* rest = parse(text.c_str(), head_, time);
  if (rest == nullptr) return std::nullopt;
  std::string_view digits;
  const char* const head_end = rest;
  if (fraction_ && (!may_lack_fraction_ || *rest == '.' || *rest == ',')) {
    const char* const first = rest + (may_lack_fraction_ ? 1 : 0);
    rest = std::find_if_not(first, text.c_str() + text.size(), is_digit);
    if (rest == first) return std::nullopt;
    digits = {first, rest};
  }
  const std::int64_t billionths = billionths_of(digits);
  const bool lacks_zone = tail_ == "%z" && *rest == '\0';
  if (has_letter(tail_, "p")) {  // AM or PM changes the hour, so both are parsed together
    text.erase(static_cast<std::size_t>(head_end - text.c_str()), static_cast<std::size_t>(rest - head_end));
    time = {};
    rest = parse(text.c_str(), head_ + tail_, time);
  } else if (!lacks_zone && !tail_.empty()) {
    rest = parse(rest, tail_, time);
  }
  if (rest == nullptr || rest != text.c_str() + text.size()) return std::nullopt;
  const std::optional<std::int64_t> seconds = seconds_of(time, has_date_);
  if (!seconds) return std::nullopt;
  return normalised_stamp(*seconds + seconds_per_day * days, billionths);
}

const std::vector<StampPattern>& known_stamp_patterns() {
  static const std::vector<StampPattern> patterns = [] {
    constexpr std::array dates{"%Y-%m-%d", "%Y/%m/%d", "%Y.%m.%d", "%d.%m.%Y", "%d.%m.%y",
                               "%d/%m/%Y", "%m/%d/%Y", "%d/%m/%y", "%m/%d/%y", "%d-%m-%Y",
                               "%m-%d-%Y", "%d-%b-%Y", "%d %b %Y", "%b %d %Y", "%b %d, %Y"};
    constexpr std::array clocks{" %H:%M:%S.%f", " %H:%M", " %I:%M:%S.%f %p", " %I:%M %p", ""};
    std::vector<StampPattern> all;
    const auto add = [&all](const std::string& pattern) {
      const bool known = std::any_of(all.begin(), all.end(), [&](const StampPattern& other) {
        return other.text() == pattern + "%z";  // the value may have no zone
      });
      if (!known) all.emplace_back(pattern);
    };
    for (const char* const iso : {"%Y-%m-%dT%H:%M:%S.%f%z", "%Y-%m-%d %H:%M:%S.%f%z", "%Y-%m-%dT%H:%M%z",
                                  "%Y-%m-%d %H:%M%z", "%Y/%m/%d %H:%M:%S.%f%z", "%Y/%m/%d %H:%M%z",
                                  "%Y/%m/%dT%H:%M:%S.%f%z", "%Y-%m-%dt%H:%M:%S.%f%z", "%Y-%m-%d %H:%M:%S.%f UTC"})
      all.emplace_back(iso);
    for (const char* const date : dates)
      for (const char* const clock : clocks) add(std::string(date) + clock);
    for (const char* const other : {"%Y/%m/%d/%H:%M:%S.%f", "%Y-%m-%d_%H-%M-%S.%f", "%Y%m%dT%H%M%S.%f%z",
                                    "%Y%m%d %H:%M:%S.%f", "%a %b %d %H:%M:%S %Y", "%a, %d %b %Y %H:%M:%S %z",
                                    "%H:%M:%S.%f", "%H:%M", "%M:%S.%f", "%I:%M:%S.%f %p", "%I:%M %p"})
      all.emplace_back(other);
    return all;
  }();
  return patterns;
}

bool is_known_time(std::string_view value) {
  value = without_blanks(value);
  constexpr std::size_t shortest = 4;
  if (value.size() < shortest || !std::any_of(value.begin(), value.end(), is_digit)) return false;
  const std::vector<StampPattern>& all = known_stamp_patterns();
  return std::any_of(all.begin(), all.end(),
                     [&](const StampPattern& pattern) { return pattern.read(value).has_value(); });
}

}  // namespace modebank
