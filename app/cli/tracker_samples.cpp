// Selects the samples that a live filter uses, in order of time. After a gap or a jump of the clock,
// the filter starts anew.
#include "app/cli/tracker.hpp"

namespace modebank::app {

void Tracker::take_sample(const TimedSample& sample) {
  if (!comes_in_time(sample.time_s)) return;
  before_leap_.reset();
  if (last_s_ && filter_.started() && is_gap(*last_s_, sample.time_s)) {
    before_leap_ = BeforeLeap{*last_s_, samples_, validity_, filter_.snapshot()};
    samples_.restart();
  }
  if (++came_ == 1) {
    first_ = sample;
    first_at_ = out_.size();
  } else {
    first_.reset();
  }
  last_s_ = sample.time_s;
  samples_.push(sample);
  while (const TimedSample* const ready = samples_.next()) step(*ready);
}

/// The second sample shows that the unit of times was wrong, so the first sample is filtered again.
void Tracker::correct_first(double time_s) {
  if (!first_) return;
  const bool has_left = !first_at_ && estimates_ > 0;
  if (has_left)
    messages_.say(fmt::format("{}: times are not in seconds; the first sample's time is {} s", place_, time_s));
  first_->time_s = time_s;
  first_->rest_s = 0.0;
  last_s_ = time_s;
  restart();
  samples_.push(*first_);
  const TimedSample* const ready = samples_.next();
  if (ready == nullptr) return;
  if (has_left) {
    const FilterEstimate& estimate = filter_.step(ready->time_s, ready->input, ready->measurement);
    validity_.judge(ready->time_s, ready->input, estimate, filter_.started());
    return;
  }
  out_.resize(*first_at_);
  estimates_ = 0;
  step(*ready);
}

bool Tracker::is_gap(double from_s, double to_s) const {
  return SampleFeed::steps_between(from_s, to_s, bank_.dt_s) > longest_gap_steps;
}

/// If a sample jumps ahead but the next sample continues from before the jump, the time of the jumping sample was
/// wrong. The filter then returns to its state before the jump. A time that goes back by more than the filter's memory
/// belongs to another clock.
bool Tracker::comes_in_time(double time_s) {
  if (!last_s_ || time_s > *last_s_) return true;
  if (before_leap_ && time_s > before_leap_->time_s && !is_gap(before_leap_->time_s, time_s)) {
    messages_.say_once(
        place_, fmt::format("time goes back from {} s to {} s, which follows {} s: the filter goes on from there",
                            *last_s_, time_s, before_leap_->time_s));
    filter_.restore(before_leap_->filter);
    samples_ = before_leap_->samples;
    validity_ = before_leap_->validity;
    return true;
  }
  if (*last_s_ - time_s > static_cast<double>(longest_gap_steps) * bank_.dt_s) {
    messages_.say_once(place_,
                       fmt::format("time goes back from {} s to {} s: the filter starts anew", *last_s_, time_s));
    restart();
    last_s_.reset();
    return true;
  }
  complain(fmt::format("time {} s is not after {} s", time_s, *last_s_));
  return false;
}

}  // namespace modebank::app
