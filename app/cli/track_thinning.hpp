#pragma once

#include <algorithm>
#include <cmath>

namespace modebank::app {

/// Selects samples if they arrive faster than the filter's steps. For each step it takes the nearest sample. If the
/// stream is about as fast as the model, it takes all samples, even with jitter. All times are the samples' stamps.
class SampleThinning {
 public:
  /// `period_s`: step of the model; 0: every sample is taken.
  explicit SampleThinning(double period_s) : period_s_(period_s) {}

  /// Whether the filter takes the next sample.
  bool takes(double time_s) {
    since_s_ = time_s - last_s_;
    last_s_ = time_s;
    if (!(period_s_ > 0.0)) return true;
    if (!(since_s_ > 0.0)) return begin(time_s);  // this is the first sample, or the clock jumped back
    constexpr double weight = 0.3;  // with this weight, a source that is ten times too fast is detected at the second
                                    // sample
    spacing_s_ += weight * (std::min(since_s_, 2.0 * period_s_) - spacing_s_);  // the limit makes the effect of a gap
                                                                                // on the rate small
    if (!thins()) return begin(time_s, spacing_s_);                             // only jitter
    const double late_s = time_s - due_s_;
    if (late_s < -0.5 * spacing_s_) return false;
    constexpr double follows = 0.1;  // the steps follow the stamps by this fraction, so that 10.1 Hz is accepted for 10
                                     // Hz
    due_s_ += period_s_ + (std::abs(late_s) > 0.5 * period_s_ ? late_s : follows * late_s);
    return true;
  }
  /// Whether the samples arrive so fast that some are ignored.
  bool thins() const { return spacing_s_ < 0.75 * period_s_; }
  /// Time between the last sample and the one before.
  double since_s() const { return since_s_; }

 private:
  double period_s_;
  double spacing_s_ = period_s_;  ///< recent mean time between samples
  double last_s_ = std::nan(""), since_s_ = 0.0, due_s_ = 0.0;

  bool begin(double time_s) { return begin(time_s, period_s_); }
  bool begin(double time_s, double spacing_s) {
    spacing_s_ = spacing_s;
    due_s_ = time_s + period_s_;
    return true;
  }
};

}  // namespace modebank::app
