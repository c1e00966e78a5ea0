#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <deque>
#include <vector>

#include "ident/data/streams.hpp"

namespace modebank::app {

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

  bool averages() const { return rate_hz > 0.0 && averaged.any(); }
};

/// Applies to live samples a lag between inputs and states, and a rate, as io/import does with whole runs. States are
/// interpolated and inputs held. If samples come fast enough (is_averaged_at), columns are averaged over the step that
/// ends at the new sample. With a negative lag a state waits for its acting input, which arrives -lag_s later. If the
/// sample rate is below three quarters of the requested rate, samples pass unchanged.
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
  /// Times but time_s are relative to origin_s_.
  struct Kept {
    double at_s;
    TimedSample sample;
  };

  Alignment alignment_;
  double origin_s_ = 0.0, first_s_ = 0.0, spacing_s_ = 0.0, ready_s_ = 0.0;
  std::deque<Kept> samples_;  ///< samples that are still needed; always includes the last one
  std::size_t next_ = 0;      ///< index of the next output sample; used if samples keep their times
  std::size_t pushed_ = 0;
  bool resamples_ = false, averages_ = false;
  std::vector<double> recent_s_;  ///< the last time steps; needed until the sample period is known
  double steps_ = 0.0;            ///< number of steps at the rate, from first_s_ to the next output sample
  TimedSample ready_;

  double rounding_s(double at_s) const;
  void learn_rate(double since_s);
  double due_s() const;
  std::deque<Kept>::const_iterator after(double at_s) const;
  void take(Eigen::VectorXd TimedSample::*signal, double at_s, double end_s, const std::vector<Eigen::Index>& averaged);
  bool gapes(double at_s) const;
  void forget();
};

}  // namespace modebank::app
