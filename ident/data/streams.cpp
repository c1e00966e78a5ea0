#include "ident/data/streams.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double last(const VectorXd& time_s) { return time_s(time_s.size() - 1); }

/// Smaller time differences are rounding errors of decimal stamps, of k / rate or of t - lag. The limit is a millionth
/// of the mean period, but at least the resolution of a double at these times (epoch seconds: 2.4e-7).
double time_tolerance(const VectorXd& time_s) {
  constexpr double share_of_period = 1e-6, units_in_last_place = 4.0;
  const double largest = std::max(std::abs(time_s(0)), std::abs(last(time_s)));
  const double resolution = units_in_last_place * std::numeric_limits<double>::epsilon() * largest;
  if (time_s.size() < 2) return resolution;
  return std::max(resolution, share_of_period * (last(time_s) - time_s(0)) / static_cast<double>(time_s.size() - 1));
}

/// Advances `sample` to the last sample at or before `time`; -1 if all samples are later. On entry `sample` holds the
/// result for an earlier time.
Index advance(const VectorXd& samples, Index sample, double time) {
  while (sample + 1 < samples.size() && samples(sample + 1) <= time) ++sample;
  return sample;
}

/// The times of a grid, except times deep inside a gap of a stream, where no data exist. So the cost of a pause is
/// bounded, whatever its duration. Shorter gaps keep all their grid times.
class Grid {
 public:
  Grid(double first, double end, double rate_hz) : first_(first), end_(end), rate_hz_(rate_hz) {}

  /// Removes the times in the long gaps of a stream. The sample of time s acts at time acts_at(s).
  template <class ActsAt>
  void skip_gaps(const VectorXd& stream_s, ActsAt acts_at) {
    samples_ = std::max(samples_, stream_s.size());
    if (stream_s.size() < 2) return;
    const double longest = std::max(gap_periods * median_period_s(stream_s), longest_gap / rate_hz_);
    for (Index k = 1; k < stream_s.size(); ++k)
      if (stream_s(k) - stream_s(k - 1) > longest)
        gaps_.push_back({acts_at(stream_s(k - 1)) + margin / rate_hz_, acts_at(stream_s(k)) - margin / rate_hz_});
  }

  VectorXd times() {
    std::sort(gaps_.begin(), gaps_.end());
    std::vector<double> times;
    const double last = std::floor((end_ - first_) * rate_hz_ + rounding);
    std::size_t gap = 0;
    double k = 0.0;
    while (k <= last) {
      const double time = first_ + k / rate_hz_;
      while (gap < gaps_.size() && gaps_[gap].second <= time) ++gap;
      if (gap < gaps_.size() && gaps_[gap].first < time)
        k = std::max(k, std::floor((gaps_[gap].second - first_) * rate_hz_));
      else
        times.push_back(time);
      ++k;
      if (std::ssize(times) > std::max(most_times, most_per_sample * samples_)) refuse(times.back());
    }
    return VectorXd::Map(times.data(), std::ssize(times));
  }

 private:
  static constexpr double rounding = 1e-6;  // share of a period; keeps the last time if k / rate_hz misses it only by
                                            // rounding

  // in periods of the model; a filter restarts after a gap of 50 periods
  static constexpr double longest_gap = 1000.0, margin = 100.0;
  /// Limits of a grid relative to its streams. A grid beyond these limits has times that are not in seconds, or a wrong
  /// rate.
  static constexpr Index most_times = 1'000'000, most_per_sample = 1000;
  double first_, end_, rate_hz_;
  Index samples_ = 0;  ///< number of samples of the longest stream
  std::vector<std::pair<double, double>> gaps_;

  [[noreturn]] void refuse(double time) const {
    std::ostringstream what;
    what << "a rate of " << rate_hz_ << " Hz gives more than " << most_per_sample
         << " output times per sample: " << samples_ << " samples lie from " << first_ << " s to " << end_ << " s ("
         << time << " s is the last output time). Check the unit of the times";
    throw DataError(what.str());
  }
};

VectorXd times_within(const VectorXd& time_s, double first, double end) {
  const double* const from = std::lower_bound(time_s.data(), time_s.data() + time_s.size(), first);
  const double* const to = std::upper_bound(from, time_s.data() + time_s.size(), end);
  return Eigen::Map<const VectorXd>(from, to - from);
}

}  // namespace

MatrixXd interpolate(const Stream& stream, const VectorXd& time_s) {
  const VectorXd& t = stream.time_s;
  const MatrixXd& v = stream.values;
  assert(t.size() >= 1 && v.cols() == t.size());
  MatrixXd result(v.rows(), time_s.size());
  Index j = -1;
  for (Index k = 0; k < time_s.size(); ++k) {
    j = advance(t, j, time_s(k));
    if (j < 0)
      result.col(k) = v.col(0);
    else if (j + 1 == t.size() || t(j) == time_s(k))
      result.col(k) = v.col(j);
    else
      result.col(k) = (v.col(j + 1) - v.col(j)) / (t(j + 1) - t(j)) * (time_s(k) - t(j)) + v.col(j);
  }
  return result;
}

MatrixXd average_ending(const Stream& stream, const VectorXd& time_s, double step_s) {
  const VectorXd& t = stream.time_s;
  const VectorXd starts_s = time_s.array() - step_s;
  const MatrixXd first = interpolate(stream, starts_s), end = interpolate(stream, time_s);
  MatrixXd result(end.rows(), end.cols());
  Index next = 0;  // first sample of the stream after the step's start
  for (Index k = 0; k < time_s.size(); ++k) {
    while (next < t.size() && t(next) <= starts_s(k)) ++next;
    double from_s = starts_s(k);
    VectorXd from = first.col(k), integral = VectorXd::Zero(end.rows());
    for (Index i = next; i < t.size() && t(i) < time_s(k); ++i) {
      integral += 0.5 * (t(i) - from_s) * (from + stream.values.col(i));
      from_s = t(i);
      from = stream.values.col(i);
    }
    integral += 0.5 * (time_s(k) - from_s) * (from + end.col(k));
    result.col(k) = integral / step_s;
  }
  return result;
}

void average_rows(const Stream& stream, const std::vector<Index>& rows, const VectorXd& time_s, double step_s,
                  MatrixXd& values) {
  if (rows.empty()) return;
  values(rows, Eigen::all) = average_ending({stream.time_s, stream.values(rows, Eigen::all)}, time_s, step_s);
}

MatrixXd hold(const Stream& stream, const VectorXd& time_s) {
  assert(stream.time_s.size() >= 1 && stream.values.cols() == stream.time_s.size());
  const double tolerance = time_tolerance(stream.time_s);
  MatrixXd result(stream.values.rows(), time_s.size());
  Index j = -1;
  for (Index k = 0; k < time_s.size(); ++k) {
    j = advance(stream.time_s, j, time_s(k) + tolerance);
    result.col(k) = stream.values.col(std::max<Index>(j, 0));
  }
  return result;
}

double step_scatter(const std::vector<const VectorXd*>& times_s) {
  const double period_s = median_period_s(times_s);
  double squares = 0.0;
  Index steps = 0;
  for (const VectorXd* time_s : times_s)
    for (Index k = 1; k < time_s->size(); ++k) {
      const double step_s = (*time_s)(k) - (*time_s)(k - 1);
      if (!(step_s <= gap_periods * period_s)) continue;
      squares += (step_s - period_s) * (step_s - period_s);
      ++steps;
    }
  return period_s > 0.0 && steps > 0 ? std::sqrt(squares / static_cast<double>(steps)) / period_s : 0.0;
}

void blank_gaps(const VectorXd& stream_time_s, const VectorXd& time_s, MatrixXd& values) {
  const double longest = gap_periods * median_period_s(stream_time_s);
  Index j = 0;  // first sample of the stream at or after time_s(k)
  for (Index k = 0; k < time_s.size(); ++k) {
    while (j < stream_time_s.size() && stream_time_s(j) < time_s(k)) ++j;
    const bool between = j > 0 && j < stream_time_s.size() && stream_time_s(j) != time_s(k);
    if (between && stream_time_s(j) - stream_time_s(j - 1) > longest)
      values.col(k).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

MatrixXd hold_mid_transition(const Stream& inputs, const VectorXd& time_s, double lag_s) {
  const Index N = time_s.size();
  const double half_period = 0.5 * median_period_s(time_s);
  VectorXd middle(N);
  for (Index k = 0; k < N; ++k) {
    const double t = time_s(k) + (k + 1 < N ? std::min(0.5 * (time_s(k + 1) - time_s(k)), half_period) : half_period);
    middle(k) = t - lag_s;
  }
  return hold(inputs, middle);
}

VectorXd joint_times(const VectorXd& states_time_s, const VectorXd& inputs_time_s, const JoinTimes& options) {
  const auto acts_at = [&](double s) { return s + options.lag_s; };  // on the states' clock
  const double first = std::max(states_time_s(0), acts_at(inputs_time_s(0)));
  const double end = std::min(last(states_time_s), acts_at(last(inputs_time_s)));
  if (options.rate_hz > 0.0) {
    Grid grid(first, end, options.rate_hz);
    grid.skip_gaps(states_time_s, [](double s) { return s; });
    grid.skip_gaps(inputs_time_s, acts_at);
    return grid.times();
  }
  if (options.lag_s == 0.0) return times_within(inputs_time_s, first, end);
  const double rounding = time_tolerance(inputs_time_s);  // the rounding of t - lag_s must not exclude a sample
  return times_within(inputs_time_s, std::max(states_time_s(0), first - rounding),
                      std::min(last(states_time_s), end + rounding));
}

}  // namespace modebank
