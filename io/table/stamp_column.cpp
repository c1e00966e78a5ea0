#include "io/table/stamp_column.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "ident/base/not_a_number.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

constexpr double largest_whole = 9.2e18;  // that 64 bits hold
constexpr double exact_below = 1e6;       // a double tells billionths of what is smaller
constexpr std::size_t rows_for_unit = 4096;

std::int64_t ns_per(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::ms:
      return 1'000'000;
    case TimeUnit::us:
      return 1'000;
    case TimeUnit::ns:
      return 1;
    default:
      return 1'000'000'000;
  }
}

std::string_view in_words(TimeUnit unit) {
  constexpr std::array<std::string_view, 5> words{"", "seconds", "milliseconds", "microseconds", "nanoseconds"};
  return words.at(static_cast<std::size_t>(unit));
}

/// What a name or a unit says of itself: time_ms, "stamp [us]", nsec.
std::optional<TimeUnit> unit_in(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  while (!text.empty() && std::string_view(")] ").find(text.back()) != std::string_view::npos) text.pop_back();
  const std::size_t start = text.find_last_of("_[( .");
  const std::string word = start == std::string::npos ? text : text.substr(start + 1);
  const auto is_one_of = [&](std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  if (is_one_of({"s", "sec", "secs", "second", "seconds"})) return TimeUnit::s;
  if (is_one_of({"ms", "msec", "msecs", "millis", "millisecond", "milliseconds"})) return TimeUnit::ms;
  if (is_one_of({"us", "usec", "usecs", "micros", "microsecond", "microseconds", "\xC2\xB5s", "\xCE\xBCs"}))
    return TimeUnit::us;
  if (is_one_of({"ns", "nsec", "nsecs", "nanos", "nanosecond", "nanoseconds"})) return TimeUnit::ns;
  return std::nullopt;
}

/// Epochs of robots: 1998 to 2103, in seconds.
std::optional<TimeUnit> unit_of_epoch(double stamp) {
  constexpr double first_s = 9e8, last_s = 4.2e9;
  double scale = 1.0;
  for (const TimeUnit unit : {TimeUnit::s, TimeUnit::ms, TimeUnit::us, TimeUnit::ns}) {
    if (stamp >= first_s * scale && stamp <= last_s * scale) return unit;
    scale *= 1e3;
  }
  return std::nullopt;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of whole numbers that are this far apart: a robot samples at 0.1 Hz or faster, so what is further apart than ten is
/// no seconds, unless it is minutes.
TimeUnit unit_of_spacing(double spacing) {
  constexpr double slowest_s = 10.0, minute_s = 60.0, hour_s = 3600.0;
  const bool minutes = spacing <= hour_s && std::fmod(spacing, minute_s) == 0.0;
  if (spacing <= slowest_s || minutes) return TimeUnit::s;
  if (spacing <= slowest_s * 1e3) return TimeUnit::ms;
  return spacing <= slowest_s * 1e6 ? TimeUnit::us : TimeUnit::ns;
}

}  // namespace

StampColumn::StampColumn(const TimeRequest& request, std::string_view stated_unit)
    : request_(request), stated_unit_(stated_unit) {}

void StampColumn::reserve(std::size_t rows) {
  stamps_.reserve(rows);
  as_written_.reserve(rows);
}

void StampColumn::push(Stamp stamp, double as_written) {
  whole_numbers_ = whole_numbers_ && stamp.billionths == 0;
  stamps_.push_back(stamp);
  as_written_.push_back(as_written);
}

NumberStatus StampColumn::add(std::string_view text) {
  if (kind_ != Kind::iso) {
    const ParsedNumber number = parse_number(text);
    if (number.status == NumberStatus::ok && std::abs(number.value) < largest_whole) {
      kind_ = Kind::number;
      const bool exact_anyway = std::abs(number.value) < exact_below;
      const std::optional<Stamp> exact = exact_anyway ? std::nullopt : parse_decimal_stamp(text);
      push(exact ? *exact : stamp_of(number.value), number.value);
      return NumberStatus::ok;
    }
    if (number.status == NumberStatus::ok) return NumberStatus::out_of_range;
    if (number.status != NumberStatus::text || kind_ == Kind::number) return number.status;
  }
  const std::optional<Stamp> iso = parse_iso_time(text);
  if (!iso) return parse_number(text).status == NumberStatus::missing ? NumberStatus::missing : NumberStatus::text;
  kind_ = Kind::iso;
  push(*iso, 0.0);
  return NumberStatus::ok;
}

void StampColumn::add(double value) {
  if (!(std::abs(value) < largest_whole)) return add_missing();
  kind_ = Kind::number;
  push(stamp_of(value), value);
}

void StampColumn::add(std::int64_t value) {
  kind_ = Kind::number;
  push({value, 0}, static_cast<double>(value));
}

void StampColumn::add_missing() {
  stamps_.emplace_back();
  as_written_.push_back(not_a_number);
}

bool StampColumn::add_nanoseconds(std::string_view text) {
  constexpr std::int64_t end = 1'000'000'000;
  const std::optional<Stamp> stamp = parse_decimal_stamp(text);
  if (!stamp || stamp->billionths != 0 || stamp->whole < 0 || stamp->whole >= end) return false;
  if (stamps_.back().billionths != 0) return false;  // the seconds have a fraction of their own
  stamps_.back().billionths = static_cast<std::int32_t>(stamp->whole);
  return true;
}

TimeUnit StampColumn::unit_of_numbers(std::vector<std::string>& notes) const {
  if (const auto stated = unit_in(stated_unit_)) return *stated;
  if (request_.column.size() > 1)  // a column called "s" may be anything
    if (const auto named = unit_in(request_.column)) return *named;
  std::vector<double> known, spacings;
  for (const double value : as_written_) {
    if (std::isnan(value)) continue;
    if (known.size() == rows_for_unit) break;
    if (!known.empty() && value > known.back()) spacings.push_back(value - known.back());
    known.push_back(value);
  }
  if (const auto epoch = unit_of_epoch(median(known))) return *epoch;
  if (!whole_numbers_) return TimeUnit::s;
  const double spacing = median(spacings);
  const TimeUnit unit = unit_of_spacing(spacing);
  if (unit == TimeUnit::s && spacing > 1.0)
    notes.push_back(
        fmt::format("column {}: whole numbers {} apart are taken for seconds (data.time_unit = ms says "
                    "otherwise)",
                    request_.column, spacing));
  return unit;
}

TimeUnit StampColumn::found_unit(std::vector<std::string>& notes) const {
  if (kind_ == Kind::iso || !request_.nanoseconds.empty()) return TimeUnit::s;
  if (request_.unit != TimeUnit::automatic) return request_.unit;
  const TimeUnit unit = unit_of_numbers(notes);
  if (unit != TimeUnit::s)
    notes.push_back(
        fmt::format("column {} counts {} (data.time_unit = {})", request_.column, in_words(unit), name_of(unit)));
  return unit;
}

void StampColumn::finish(std::string_view file, Table& table) {
  const TimeUnit unit = found_unit(table.notes);
  const std::int64_t scale = ns_per(unit), most = std::numeric_limits<std::int64_t>::max() / scale - 1;
  table.time_ns.resize(stamps_.size());
  for (std::size_t k = 0; k < stamps_.size(); ++k) {
    const Stamp& stamp = stamps_[k];
    if (stamp.whole > most || stamp.whole < -most)  // the least number has no absolute value
      throw DataError(fmt::format("{}:{}: column {}: {} {} is no time (data.time_unit)", file, table.line[k],
                                  request_.column, stamp.whole, in_words(unit)));
    const bool missing = std::isnan(as_written_[k]);
    table.time_ns[k] = missing ? missing_stamp : stamp.whole * scale + stamp.billionths / (1'000'000'000 / scale);
  }
  const bool plain = kind_ != Kind::iso && unit == TimeUnit::s && request_.nanoseconds.empty();
  if (plain) table.time_s = std::move(as_written_);
}

}  // namespace modebank
