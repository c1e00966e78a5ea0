#include "app/cli/aligned_samples.hpp"

#include <cmath>
#include <limits>

#include "ident/base/not_a_number.hpp"

namespace modebank::app {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Times count as equal if they differ by less than this, as in io/import.
double AlignedSamples::rounding_s(double at_s) const {
  constexpr double share_of_spacing = 1e-6, units_in_last_place = 4.0;
  return std::max(share_of_spacing * spacing_s_,
                  units_in_last_place * std::numeric_limits<double>::epsilon() * std::abs(at_s));
}

void AlignedSamples::push(const TimedSample& sample) {
  constexpr double exact_below_s = 1e6, weight = 0.1;
  if (pushed_ == 0 && std::abs(sample.time_s) >= exact_below_s) origin_s_ = std::floor(sample.time_s);
  const double at_s = origin_s_ == 0.0 ? sample.time_s : sample.time_s - origin_s_ + sample.rest_s;
  if (pushed_ == 0) {
    first_s_ = at_s + std::max(0.0, alignment_.lag_s);
  } else {
    const double since_s = at_s - samples_.back().at_s;
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
  if (recent_s_.size() > steps) recent_s_.erase(recent_s_.begin());
  std::vector<double> sorted = recent_s_;
  std::sort(sorted.begin(), sorted.end());
  const double period_s = sorted[sorted.size() / 2];
  resamples_ = period_s * alignment_.rate_hz < slow;
  if (!resamples_) return;
  averages_ = alignment_.averages() && is_averaged_at(alignment_.rate_hz, period_s);
  if (steps_ > 0.0) first_s_ = ready_s_;
  if (steps_ > 0.0 || averages_) steps_ = 1.0;  // no complete step leads up to the first sample
}

/// Time of the next output sample; infinite before its input sample.
double AlignedSamples::due_s() const {
  if (resamples_) return first_s_ + steps_ / alignment_.rate_hz;
  return next_ < samples_.size() ? samples_[next_].at_s : std::numeric_limits<double>::infinity();
}

const TimedSample* AlignedSamples::next() {
  if (samples_.empty() || (alignment_.averages() && pushed_ < 2)) return nullptr;
  while (!resamples_ && due_s() < first_s_ - rounding_s(first_s_)) ++next_;
  forget();
  const double at_s = due_s(), acting_s = at_s - alignment_.lag_s;
  if (std::isinf(at_s) || samples_.back().at_s + rounding_s(at_s) < std::max(at_s, acting_s)) return nullptr;
  ready_s_ = at_s;
  if (resamples_) {
    ready_.time_s = origin_s_ + at_s;
    take(&TimedSample::measurement, at_s, at_s, alignment_.averaged.states);
    if (gapes(at_s) || (averages_ && gapes(at_s - 1.0 / alignment_.rate_hz)))
      ready_.measurement.setConstant(not_a_number);
  } else {
    ready_ = samples_[next_].sample;
  }
  if (resamples_ || alignment_.lag_s != 0.0) {
    // held: the value of the last sample
    const auto later = after(acting_s + rounding_s(acting_s));
    const double held_s = (later == samples_.begin() ? later : std::prev(later))->at_s;
    take(&TimedSample::input, held_s, acting_s - alignment_.averaged.further_lag_s, alignment_.averaged.inputs);
  }
  // Also counts the first sample, which was returned before the sample period was known.
  steps_ += 1.0;
  ++next_;
  return &ready_;
}

/// The first sample after a time.
std::deque<AlignedSamples::Kept>::const_iterator AlignedSamples::after(double at_s) const {
  return std::upper_bound(samples_.begin(), samples_.end(), at_s,
                          [](double t, const Kept& kept) { return t < kept.at_s; });
}

/// Takes a signal by interpolation, the averaged columns by their means over the step that ends at `end_s`.
void AlignedSamples::take(VectorXd TimedSample::*signal, double at_s, double end_s,
                          const std::vector<Eigen::Index>& averaged) {
  Stream stream{VectorXd(std::ssize(samples_)),
                MatrixXd((samples_.front().sample.*signal).size(), std::ssize(samples_))};
  for (Eigen::Index k = 0; k < stream.time_s.size(); ++k) {
    stream.time_s(k) = samples_[static_cast<std::size_t>(k)].at_s;
    stream.values.col(k) = samples_[static_cast<std::size_t>(k)].sample.*signal;
  }
  MatrixXd values = interpolate(stream, VectorXd::Constant(1, at_s));
  if (averages_) average_rows(stream, averaged, VectorXd::Constant(1, end_s), 1.0 / alignment_.rate_hz, values);
  ready_.*signal = values;
}

/// Whether a time lies in a gap between two samples.
bool AlignedSamples::gapes(double at_s) const {
  const auto later = after(at_s);
  if (later == samples_.begin() || later == samples_.end()) return false;
  const double before_s = std::prev(later)->at_s;
  return before_s < at_s && later->at_s - before_s > gap_periods * spacing_s_;
}

/// Drops samples that no later output needs.
void AlignedSamples::forget() {
  const double at_s = std::min(due_s(), samples_.back().at_s);
  double reach_s = alignment_.lag_s + (alignment_.averaged.inputs.empty() ? 0.0 : alignment_.averaged.further_lag_s);
  reach_s = std::max(0.0, reach_s) + (alignment_.averages() ? 1.0 / alignment_.rate_hz : 0.0);
  const double needed_s = at_s - std::max(alignment_.lag_s, reach_s) - rounding_s(at_s);
  while (samples_.size() > 1 && samples_[1].at_s < needed_s && (resamples_ || next_ > 0)) {
    samples_.pop_front();
    if (next_ > 0) --next_;
  }
}

}  // namespace modebank::app
