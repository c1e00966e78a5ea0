#include "io/table/stamp_form.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace modebank {

namespace {

constexpr std::size_t rows_for_unit = 4096;
constexpr double minute_s = 60.0, hour_s = 3600.0, day_s = 86400.0;

struct Numbers {
  double size = 0.0;     ///< median of the numbers
  double spacing = 0.0;  ///< median of the positive increments; 0 if there are none
  std::vector<double> first;
};

Numbers first_numbers(const std::vector<double>& values) {
  std::vector<double> known, spacings;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    if (known.size() == rows_for_unit) break;
    if (!known.empty() && value > known.back()) spacings.push_back(value - known.back());
    known.push_back(value);
  }
  return {upper_median(known), upper_median(spacings), known};
}

bool is_multiple(double value, double of) { return std::fmod(value, of) == 0.0; }

/// Whether this interval is typical of a logger that writes whole units since an epoch. Typical are intervals of at
/// most a minute, and whole minutes, hours or days.
bool is_logging_interval(double seconds) {
  if (seconds <= minute_s) return true;
  if (seconds <= hour_s) return is_multiple(seconds, minute_s);
  return seconds <= day_s ? is_multiple(seconds, hour_s) && is_multiple(day_s, seconds) : is_multiple(seconds, day_s);
}

/// The unit in which the numbers, counted from 1970, lie in the years 1998 to 2103. Robots log in this time.
std::optional<TimeUnit> unit_of_epoch(const Numbers& numbers, bool whole) {
  constexpr double first_s = 9e8, last_s = 4.2e9;
  double scale = 1.0;
  for (const TimeUnit unit : {TimeUnit::s, TimeUnit::ms, TimeUnit::us, TimeUnit::ns}) {
    if (numbers.size >= first_s * scale && numbers.size <= last_s * scale &&
        (!whole || is_logging_interval(numbers.spacing / scale)))
      return unit;
    scale *= 1e3;
  }
  return std::nullopt;
}

/// The unit of whole numbers. A robot samples at 0.1 Hz or faster, so numbers that differ by more than ten are not
/// seconds, unless they are full minutes. Those that differ by 1000 to 10,000 are microseconds of 100 Hz to 1 kHz, and
/// not milliseconds of less than 1 Hz.
/// A robot runs for less than ten days. A unit that gives more days is therefore rejected, unless the finer unit gives
/// a sampling rate above 2 kHz.
TimeUnit unit_of_spacing(const Numbers& numbers) {
  constexpr double slowest_s = 10.0, longest_s = 9e5, fastest_s = 5e-4;
  if (numbers.spacing <= slowest_s || (numbers.spacing <= hour_s && is_multiple(numbers.spacing, minute_s)))
    return TimeUnit::s;
  double scale = 1e3;
  for (const TimeUnit unit : {TimeUnit::ms, TimeUnit::us}) {
    const bool too_long = numbers.size > longest_s * scale && numbers.spacing >= fastest_s * 1e3 * scale;
    if (numbers.spacing <= (unit == TimeUnit::ms ? 1.0 : slowest_s) * scale && !too_long) return unit;
    scale *= 1e3;
  }
  return TimeUnit::ns;
}

/// Whether numbers, read as days, lie at full seconds or minutes that are usual for loggers: every 5 or 10 s, every
/// minute, every quarter of an hour.
bool are_at_logging_intervals(const Numbers& numbers) {
  constexpr double rounding_s = 0.1;  // rounding error of days with six decimals
  const double interval_s = std::round(numbers.spacing * day_s);
  if (interval_s < 2.0 || !is_logging_interval(interval_s)) return false;
  const double grid_s = std::min(interval_s, minute_s);
  return std::all_of(numbers.first.begin(), numbers.first.end(), [&](double days) {
    return std::abs(std::remainder((days - std::floor(days)) * day_s, grid_s)) < rounding_s;
  });
}

/// Whether numbers are days since an epoch, with the time of day as a fraction. They are if, read as seconds, their
/// rate would be above 20 kHz. They also are if the rate would be above 1 kHz and they lie at full seconds of days.
bool are_serial_days(const Numbers& numbers) {
  constexpr double fastest_s = 5e-5, fast_s = 1e-3;
  return first_day_of(numbers.size) != 0 && numbers.spacing > 0.0 &&
         (numbers.spacing < fastest_s || (numbers.spacing < fast_s && are_at_logging_intervals(numbers)));
}

}  // namespace

std::int64_t first_day_of(double serial_day) {
  constexpr std::int64_t spreadsheet = 25569, matlab = 719529;
  if (serial_day > 2e4 && serial_day < 8e4) return spreadsheet;  // years 1954 to 2119
  return serial_day > 7.1e5 && serial_day < 8e5 ? matlab : 0;    // years 1943 to 2190
}

bool join_patterns(StampForm& ours, const StampForm& theirs) {
  using Names = std::vector<std::string>;
  const auto has = [](const Names& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const auto reads_as_first = [&](const StampForm& form, const std::string& pattern) {
    return pattern == form.patterns.front() || has(form.alike, pattern);
  };
  StampForm both;
  for (const Names* names : {&ours.patterns, &ours.alike})
    for (const std::string& pattern : *names) {
      if (!has(theirs.patterns, pattern) && !has(theirs.alike, pattern)) continue;
      const bool as_first = !both.patterns.empty() && reads_as_first(ours, pattern) &&
                            reads_as_first(theirs, pattern) && reads_as_first(ours, both.patterns.front()) &&
                            reads_as_first(theirs, both.patterns.front());
      (as_first ? both.alike : both.patterns).push_back(pattern);
    }
  if (both.patterns.empty()) return false;
  ours.patterns = std::move(both.patterns);
  ours.alike = std::move(both.alike);
  return true;
}

double upper_median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

StampForm form_of_numbers(std::string_view column, const std::vector<double>& values, bool all_whole,
                          std::vector<std::string>& notes) {
  using Ground = StampForm::Ground;
  const Numbers numbers = first_numbers(values);
  if (const auto epoch = unit_of_epoch(numbers, all_whole)) return {Ground::magnitude, *epoch};
  if (all_whole) {
    const TimeUnit unit = unit_of_spacing(numbers);
    if (unit == TimeUnit::s && numbers.spacing > 1.0)
      notes.push_back(fmt::format(
          "column {}: whole numbers {} apart are taken for seconds (for milliseconds set data.time_unit = ms)", column,
          numbers.spacing));
    return {Ground::spacing, unit};
  }
  if (are_serial_days(numbers)) return {Ground::magnitude, TimeUnit::d};
  constexpr double doubtful_s = 1e-3;
  if (first_day_of(numbers.size) != 0 && (numbers.spacing < doubtful_s || are_at_logging_intervals(numbers)))
    notes.push_back(
        fmt::format("column {}: numbers {:.3g} apart are taken for seconds (for days set data.time_unit = d)", column,
                    numbers.spacing));
  return {Ground::assumed, TimeUnit::s};
}

}  // namespace modebank
