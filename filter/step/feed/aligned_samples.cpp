#include "filter/step/feed/aligned_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace modebank {

namespace {

/// Times that differ by less are equal but for rounding, as io/import takes them.
double tolerance_s(double time_s, double spacing_s) {
  constexpr double share_of_spacing = 1e-6, units_in_last_place = 4.0;
  return std::max(share_of_spacing * spacing_s,
                  units_in_last_place * std::numeric_limits<double>::epsilon() * std::abs(time_s));
}

}  // namespace

void AlignedSamples::push(const TimedSample& sample) {
  if (pushed_ == 0) first_s_ = sample.time_s + std::max(0.0, alignment_.lag_s);
  if (pushed_ == 1 && std::isfinite(before_s_)) {
    first_s_ = before_s_;
    steps_ = 1.0;
  }
  if (pushed_ > 0) {
    constexpr double weight = 0.1, slow = 0.75;
    const double since_s = sample.time_s - newest_s();
    if (pushed_ == 1) {
      spacing_s_ = since_s;
      resamples_ = since_s * alignment_.rate_hz < slow && alignment_.rate_hz > 0.0;
    }
    spacing_s_ += weight * (std::min(since_s, 2.0 * spacing_s_) - spacing_s_);
  }
  ++pushed_;
  samples_.push_back(sample);
}

/// Time of the next sample; infinite while none has come.
double AlignedSamples::due_s() const {
  if (resamples_) return first_s_ + steps_ / alignment_.rate_hz;
  return next_ < samples_.size() ? samples_[next_].time_s : std::numeric_limits<double>::infinity();
}

const TimedSample* AlignedSamples::next() {
  const bool may_resample = alignment_.rate_hz > 0.0 && std::isfinite(before_s_);
  if (may_resample && pushed_ < 2) return nullptr;
  const double early_s = first_s_ - tolerance_s(first_s_, spacing_s_);
  while (!resamples_ && due_s() < early_s) ++next_;
  forget();
  const double time_s = due_s(), rounding_s = tolerance_s(time_s, spacing_s_);
  if (std::isinf(time_s)) return nullptr;
  if (!(newest_s() + rounding_s >= std::max(time_s, time_s - alignment_.lag_s))) return nullptr;
  ready_.time_s = time_s;
  if (resamples_)
    measure_at(time_s);
  else
    ready_.measurement = samples_[next_].measurement;
  if (passes())
    ready_.input = samples_[next_].input;
  else
    take_input_of(time_s - alignment_.lag_s + rounding_s);
  // Before it is known whether samples come faster than the rate, the first one has passed.
  steps_ += 1.0;
  ++next_;
  return &ready_;
}

void AlignedSamples::measure_at(double time_s) {
  constexpr double gap = 5.0;  // spacings: what lies between is not measured
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), time_s,
                                      [](const TimedSample& sample, double t) { return sample.time_s < t; });
  if (after == samples_.end()) {
    ready_.measurement = samples_.back().measurement;
  } else if (after->time_s == time_s || after == samples_.begin()) {
    ready_.measurement = after->measurement;
  } else {
    const TimedSample& before = *std::prev(after);
    const double apart_s = after->time_s - before.time_s;
    if (apart_s > gap * spacing_s_)
      ready_.measurement.setConstant(after->measurement.size(), not_a_number);
    else
      ready_.measurement =
          (after->measurement - before.measurement) / apart_s * (time_s - before.time_s) + before.measurement;
  }
}

void AlignedSamples::take_input_of(double time_s) {
  const auto after = std::upper_bound(samples_.begin(), samples_.end(), time_s,
                                      [](double t, const TimedSample& sample) { return t < sample.time_s; });
  ready_.input = (after == samples_.begin() ? after : std::prev(after))->input;
}

/// Drops samples before the next state and before the next input.
void AlignedSamples::forget() {
  const double time_s = std::min(due_s(), newest_s());
  const double needed_s = std::min(time_s, time_s - alignment_.lag_s) - tolerance_s(time_s, spacing_s_);
  while (samples_.size() > 1 && samples_[1].time_s < needed_s && (resamples_ || next_ > 0)) {
    samples_.pop_front();
    if (next_ > 0) --next_;
  }
}

}  // namespace modebank
