#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <deque>

#include "ident/base/not_a_number.hpp"
#include "ident/data/streams.hpp"

namespace modebank {

/// A sample as recorded, or as passed to a filter.
struct TimedSample {
  double time_s = 0.0;
  Eigen::VectorXd input;        ///< m
  Eigen::VectorXd measurement;  ///< n_y; missing signals are NaN
  double rest_s = 0.0;          ///< to be added to time_s: the part of a time since 1970 that a double cannot hold
};

/// Converts live samples to the form from which a bank was learned.
struct Alignment {
  double rate_hz = 0.0;  ///< above 0: faster samples are reduced to this rate; 0: samples keep their times
  double lag_s = 0.0;    ///< the input that acts at time t is the one recorded at t - lag_s
  AveragedColumns averaged = {};

  /// Samples up to this age before an estimate are stored, because later estimates need them.
  double reach_s() const {
    const double oldest_s = lag_s + (averaged.inputs.empty() ? 0.0 : averaged.further_lag_s);
    return std::max(0.0, oldest_s) + (rate_hz > 0.0 && averaged.any() ? 1.0 / rate_hz : 0.0);
  }
};

/// Applies to live samples a lag between inputs and states, and a rate. io/import does the same with whole runs. States
/// are interpolated and inputs held. If samples come fast enough (is_averaged_at), columns are averaged over the step
/// that ends at the new sample. If states are ahead of inputs, they wait, and vice versa. With a negative lag a state
/// waits for its acting input, which arrives -lag_s later. If the sample rate is below three quarters of the requested
/// rate, samples pass unchanged.
class AlignedSamples {
 public:
  explicit AlignedSamples(const Alignment& alignment) : alignment_(alignment) {}

  /// Adds the next sample in time order.
  void push(const TimedSample& sample);
  /// Returns the next finished sample, valid until the next call; null if no sample is ready. Drops samples that have
  /// no input because of a positive lag. Also drops the first sample if no complete step leads up to it.
  const TimedSample* next();
  /// Forgets all samples.
  void restart() { *this = AlignedSamples(alignment_); }

 private:
  struct Kept {
    double at_s;  ///< time relative to origin_s_, like all times below
    TimedSample sample;
  };

  Alignment alignment_;
  double origin_s_ = 0.0;
  std::deque<Kept> samples_;  ///< samples that are still needed; always includes the last one
  std::size_t next_ = 0;      ///< index of the next output sample; used if samples keep their times
  std::size_t pushed_ = 0;
  bool resamples_ = false, averages_ = false;
  double first_s_ = 0.0, spacing_s_ = 0.0;
  std::deque<double> recent_s_;  ///< time steps; needed until the sample period is known
  double steps_ = 0.0;           ///< number of steps at the rate, from first_s_ to the next output sample
  double ready_s_ = 0.0;
  TimedSample ready_;

  bool passes() const { return alignment_.lag_s == 0.0 && !resamples_; }
  double newest_at_s() const { return samples_.empty() ? not_a_number : samples_.back().at_s; }
  void learn_rate(double since_s);
  double due_s() const;
  double step_s() const { return 1.0 / alignment_.rate_hz; }
  Stream between(double from_s, double to_s, Eigen::VectorXd TimedSample::*signal) const;
  void average(Eigen::VectorXd TimedSample::*signal, const std::vector<Eigen::Index>& rows, double time_s);
  void measure_at(double time_s);
  void take_input_of(double time_s);
  void forget();
};

}  // namespace modebank
