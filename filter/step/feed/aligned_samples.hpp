#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>

#include "ident/base/not_a_number.hpp"

namespace modebank {

/// A sample as it comes or as a filter steps on it.
struct TimedSample {
  double time_s = 0.0;
  Eigen::VectorXd input;        ///< m
  Eigen::VectorXd measurement;  ///< n_y, NaN where missing
};

/// How samples that come one by one become those that a bank was learned from.
struct Alignment {
  double rate_hz = 0.0;  ///< above 0: faster samples are brought to this rate; 0: samples keep their times
  double lag_s = 0.0;    ///< the input in force at time t is the one recorded at t - lag_s
};

/// Applies a lag between inputs and states, and a rate, to samples as they come, as io/import does with whole runs:
/// states are interpolated, inputs held. The stream that is early waits for the other: with a negative lag a state
/// waits for the input that acts on it, which comes -lag_s later. Samples slower than three quarters of the rate pass
/// whole.
class AlignedSamples {
 public:
  explicit AlignedSamples(const Alignment& alignment) : alignment_(alignment) {}

  /// The next sample in the order of time.
  void push(const TimedSample& sample);
  /// The next one that is ready, valid until the next call; null: none is. What a positive lag leaves without an input
  /// is left out.
  const TimedSample* next();
  /// Forgets all samples.
  void restart() { *this = AlignedSamples(alignment_); }
  /// Before the first sample: times at the rate go on from a sample that was taken before.
  void go_on_after(double time_s) { before_s_ = time_s; }
  /// Time of the sample that was pushed last; NaN: none was.
  double newest_s() const { return samples_.empty() ? not_a_number : samples_.back().time_s; }

 private:
  Alignment alignment_;
  std::deque<TimedSample> samples_;  ///< that are still needed; the last one always
  std::size_t next_ = 0;             ///< position of the next sample to pass, where samples keep their times
  std::size_t pushed_ = 0;
  bool resamples_ = false;
  double before_s_ = not_a_number;
  double first_s_ = 0.0, spacing_s_ = 0.0;
  double steps_ = 0.0;  ///< of the rate, from first_s_ to the next sample
  TimedSample ready_;

  bool passes() const { return alignment_.lag_s == 0.0 && !resamples_; }
  double due_s() const;
  void measure_at(double time_s);
  void take_input_of(double time_s);
  void forget();
};

}  // namespace modebank
