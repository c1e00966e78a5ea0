#include "io/import/stamp_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "io/table/stamp_form.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

namespace {

/// Range of the stamps (largest minus smallest) up to each index, counted from one end.
std::vector<double> spans(const std::vector<double>& times, bool from_the_end) {
  std::vector<double> result(times.size());
  double least = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const std::size_t k = from_the_end ? times.size() - 1 - i : i;
    least = i == 0 ? times[k] : std::min(least, times[k]);
    largest = i == 0 ? times[k] : std::max(largest, times[k]);
    result[k] = largest - least;
  }
  return result;
}

/// Name of the column of nanoseconds: header.stamp.nsecs for header.stamp.secs, stamp.nanosec for stamp.sec (ROS 2).
std::string nanoseconds_beside(const std::string& seconds) {
  const auto ends = [&](std::string_view word) { return seconds.ends_with(word); };
  if (ends("secs")) return seconds.substr(0, seconds.size() - 4) + "nsecs";
  if (ends("sec")) return seconds.substr(0, seconds.size() - 3) + "nanosec";
  return "NANOSECONDS";
}

}  // namespace

double median_step(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < times.size(); ++k)
    if (times[k] > times[k - 1]) steps.push_back(times[k] - times[k - 1]);
  return upper_median(steps);
}

std::optional<std::size_t> stamp_far_out(const std::vector<std::int64_t>& stamps_ns) {
  constexpr double far = 1e3, far_in_spans = 1e5;
  constexpr std::size_t fewest = 4;
  const std::size_t N = stamps_ns.size();
  if (N < fewest) return std::nullopt;
  const std::vector<double> times(stamps_ns.begin(),
                                  stamps_ns.end());  // rounded to 256 ns; this is precise enough here
  const std::vector<double> before = spans(times, false), after = spans(times, true);
  const double period = median_step(times);
  const auto apart = [&](std::size_t a, std::size_t b) { return std::abs(times[a] - times[b]); };
  if (apart(0, 1) > far * std::max(after[1], period)) return 0;
  for (std::size_t k = 1; k + 1 < N; ++k)
    if (std::min(apart(k, k - 1), apart(k, k + 1)) > far * std::max(apart(k - 1, k + 1), period)) return k;
  if (apart(N - 1, N - 2) > far * std::max(before[N - 2], period)) return N - 1;
  for (std::size_t k = 1; k < N; ++k)
    if (apart(k, k - 1) > far_in_spans * std::max({before[k - 1], after[k], period})) return k;
  return std::nullopt;
}

std::size_t rows_before_clock_was_set(const std::vector<std::int64_t>& stamps_ns) {
  constexpr double year_ns = 3.15e16, far = 1e3;
  std::vector<std::size_t> rows;
  std::vector<double> times;
  for (std::size_t k = 0; k < stamps_ns.size(); ++k) {
    if (stamps_ns[k] == missing_stamp) continue;
    rows.push_back(k);
    times.push_back(static_cast<double>(stamps_ns[k]));
  }
  const auto leaps = [&](std::size_t k) { return times[k] - times[k - 1] >= year_ns; };
  std::size_t first = 1;
  while (first < times.size() && !leaps(first)) ++first;
  if (first >= times.size() || 2 * first > times.size()) return 0;
  const std::vector<double> before = spans(times, false), after = spans(times, true);
  const double leap = times[first] - times[first - 1];
  const bool dwarfs = leap > far * std::max({before[first - 1], median_step(times)}) && leap > after[first];
  return dwarfs ? rows[first] : 0;
}

std::vector<std::size_t> clock_restarts(const std::vector<double>& times, std::vector<std::string>& notes) {
  constexpr std::size_t fewest = 10;                  // rows on both sides
  constexpr double near_start = 0.02, date = 1000.0;  // as shares of the drive; dates do not start again
  std::vector<std::size_t> rows;
  for (std::size_t first = 0, k = fewest; k + fewest <= times.size(); ++k) {
    const double span = times[k - 1] - times[first], fallen = std::abs(times[k] - times[first]);
    const bool falls = fallen < near_start * span && times[first] < date * span;
    const auto row = times.begin() + static_cast<std::ptrdiff_t>(k), end = row + fewest;
    const bool advances = end[-1] - *row < span && std::adjacent_find(row, end, std::greater_equal<>()) == end;
    if (k >= first + fewest && falls && advances) rows.push_back(first = k);
  }
  if (!rows.empty())
    notes.push_back(fmt::format("the clock starts again in row {}; a run begins there (data.run)", rows.front() + 1));
  return rows;
}

std::string disorder_hint(const FileStream& source, Index k) {
  const Eigen::VectorXd& time_s = source.stream.time_s;
  if (const std::string never = unwritten_text(source.unwritten, source.line[static_cast<std::size_t>(k)]);
      !never.empty())
    return never;
  const Index N = time_s.size();
  constexpr Index fewest = 4;
  if (N < fewest) return {};
  if (source.time_column.ends_with(".header.stamp") && time_s(k) == time_s(k - 1))
    return " (for the recorder's times set data.time = receive_time)";
  Index repeats = 0;
  for (Index i = 1; i < N; ++i) repeats += time_s(i) == time_s(i - 1) ? 1 : 0;
  const bool whole = (time_s.array() == time_s.array().round()).all();
  if (whole && 2 * repeats > N)
    return fmt::format(" (if the nanoseconds are in another column, set data.time = {}, {})", source.time_column,
                       nanoseconds_beside(source.time_column));
  constexpr double hour_s = 3600.0;
  const double step_s = k > 1 ? std::abs(time_s(k - 1) - time_s(k - 2)) : 0.0;
  const bool an_hour = std::abs(time_s(k - 1) + step_s - time_s(k) - hour_s) <= std::min(step_s, 0.1 * hour_s);
  if (an_hour && source.origin_ns != 0)
    return " (this is an hour, as at the end of summer time; log UTC, or times with a zone such as +02:00)";
  return {};
}

}  // namespace modebank
