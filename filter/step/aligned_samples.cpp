#include "filter/step/aligned_samples.hpp"

#include <cmath>
#include <limits>
#include <vector>

namespace modebank {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Times count as equal if they differ by less than this, as in io/import.
double tolerance_s(double time_s, double spacing_s) {
  constexpr double share_of_spacing = 1e-6, units_in_last_place = 4.0;
  return std::max(share_of_spacing * spacing_s,
                  units_in_last_place * std::numeric_limits<double>::epsilon() * std::abs(time_s));
}

}  // namespace

void AlignedSamples::push(const TimedSample& sample) {
  constexpr double exact_below_s = 1e6;
  if (pushed_ == 0 && std::abs(sample.time_s) >= exact_below_s) origin_s_ = std::floor(sample.time_s);
  const double at_s = origin_s_ == 0.0 ? sample.time_s : sample.time_s - origin_s_ + sample.rest_s;
  if (pushed_ == 0) first_s_ = at_s + std::max(0.0, alignment_.lag_s);
  if (pushed_ > 0) {
    constexpr double weight = 0.1;
    const double since_s = at_s - newest_at_s();
    if (pushed_ == 1) spacing_s_ = since_s;
    spacing_s_ += weight * (std::min(since_s, 2.0 * spacing_s_) - spacing_s_);
    if (!resamples_ && alignment_.rate_hz > 0.0) learn_rate(since_s);
  }
  ++pushed_;
  samples_.push_back({at_s, sample});
}

/// Estimates the sample period. It is the median of the last steps, because a log may begin with a pause.
void AlignedSamples::learn_rate(double since_s) {
  constexpr std::size_t steps = 5;
  constexpr double slow = 0.75;
  recent_s_.push_back(since_s);
  if (recent_s_.size() > steps) recent_s_.pop_front();
  std::vector<double> sorted(recent_s_.begin(), recent_s_.end());
  std::sort(sorted.begin(), sorted.end());
  const double period_s = sorted[sorted.size() / 2];
  resamples_ = period_s * alignment_.rate_hz < slow;
  if (!resamples_) return;
  averages_ = alignment_.averaged.any() && is_averaged_at(alignment_.rate_hz, period_s);
  if (steps_ > 0.0) first_s_ = ready_s_;
  if (steps_ > 0.0 || averages_) steps_ = 1.0;  // no complete step leads up to the first sample
}

/// Time of the next output sample; infinite before the first input sample.
double AlignedSamples::due_s() const {
  if (resamples_) return first_s_ + steps_ / alignment_.rate_hz;
  return next_ < samples_.size() ? samples_[next_].at_s : std::numeric_limits<double>::infinity();
}

const TimedSample* AlignedSamples::next() {
  if (alignment_.rate_hz > 0.0 && alignment_.averaged.any() && pushed_ < 2) return nullptr;
  const double early_s = first_s_ - tolerance_s(first_s_, spacing_s_);
  while (!resamples_ && due_s() < early_s) ++next_;
  forget();
  const double time_s = due_s(), rounding_s = tolerance_s(time_s, spacing_s_);
  if (std::isinf(time_s)) return nullptr;
  if (!(newest_at_s() + rounding_s >= std::max(time_s, time_s - alignment_.lag_s))) return nullptr;
  ready_s_ = time_s;
  ready_.time_s = resamples_ ? origin_s_ + time_s : samples_[next_].sample.time_s;
  if (resamples_)
    measure_at(time_s);
  else
    ready_.measurement = samples_[next_].sample.measurement;
  if (passes())
    ready_.input = samples_[next_].sample.input;
  else
    take_input_of(time_s - alignment_.lag_s);
  // Also counts the first sample, which was returned before the sample period was known.
  steps_ += 1.0;
  ++next_;
  return &ready_;
}

/// The samples of one signal, from the last one at or before `from_s` to the first one at or after `to_s`.
Stream AlignedSamples::between(double from_s, double to_s, VectorXd TimedSample::*signal) const {
  auto first = std::upper_bound(samples_.begin(), samples_.end(), from_s,
                                [](double t, const Kept& kept) { return t < kept.at_s; });
  if (first != samples_.begin()) --first;
  auto end = std::lower_bound(first, samples_.end(), to_s, [](const Kept& kept, double t) { return kept.at_s < t; });
  if (end != samples_.end()) ++end;
  Stream stream{VectorXd(end - first), MatrixXd((first->sample.*signal).size(), end - first)};
  for (Eigen::Index k = 0; first != end; ++first, ++k) {
    stream.time_s(k) = first->at_s;
    stream.values.col(k) = first->sample.*signal;
  }
  return stream;
}

/// Replaces the picked values by their means over the step that ends at `time_s`.
void AlignedSamples::average(VectorXd TimedSample::*signal, const std::vector<Eigen::Index>& rows, double time_s) {
  if (!averages_ || rows.empty()) return;
  MatrixXd values = ready_.*signal;
  average_rows(between(time_s - step_s(), time_s, signal), rows, VectorXd::Constant(1, time_s), step_s(), values);
  ready_.*signal = values;
}

void AlignedSamples::measure_at(double time_s) {
  const auto around = [&](double at_s) { return between(at_s, at_s, &TimedSample::measurement); };
  const auto gapes = [&](const Stream& two) {
    return two.time_s.size() > 1 && two.time_s(1) - two.time_s(0) > gap_periods * spacing_s_;
  };
  ready_.measurement = interpolate(around(time_s), VectorXd::Constant(1, time_s));
  average(&TimedSample::measurement, alignment_.averaged.states, time_s);
  if (gapes(around(time_s)) || (averages_ && gapes(around(time_s - step_s()))))
    ready_.measurement.setConstant(not_a_number);
}

void AlignedSamples::take_input_of(double time_s) {
  const double rounded_s = time_s + tolerance_s(time_s, spacing_s_);
  const auto after = std::upper_bound(samples_.begin(), samples_.end(), rounded_s,
                                      [](double t, const Kept& kept) { return t < kept.at_s; });
  ready_.input = (after == samples_.begin() ? after : std::prev(after))->sample.input;
  average(&TimedSample::input, alignment_.averaged.inputs, time_s - alignment_.averaged.further_lag_s);
}

/// Drops samples that no later output needs.
void AlignedSamples::forget() {
  const double time_s = std::min(due_s(), newest_at_s());
  const double needed_s =
      std::min(time_s - alignment_.lag_s, time_s - alignment_.reach_s()) - tolerance_s(time_s, spacing_s_);
  while (samples_.size() > 1 && samples_[1].at_s < needed_s && (resamples_ || next_ > 0)) {
    samples_.pop_front();
    if (next_ > 0) --next_;
  }
}

}  // namespace modebank
