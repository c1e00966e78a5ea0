#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/gaussian.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"

/// Samples as filters need them: of a stream, or of a recorded run, moment by moment for random access.
namespace modebank {

/// After more steps without a sample a filter's state is outdated, and it restarts at the next complete measurement.
inline constexpr Eigen::Index longest_gap_steps = 50;

/// The numbers of a matrix, of which snapshots are made.
using SnapshotPart = Eigen::Map<Eigen::VectorXd>;
template <class Matrix>
SnapshotPart numbers_of(Matrix& matrix) {
  return {matrix.data(), matrix.size()};
}

/// Converts samples in time order to what a filter step takes: the acting inputs of the transition to each sample (with
/// lags), the number of model steps, and whether the filter starts. Allocates only at construction.
class SampleFeed {
 public:
  explicit SampleFeed(const Bank& bank);

  /// Adds the next sample: time (NaN: one step after the last sample), input (m) and measurement (n_y).
  void push(double time_s, const double* input, const double* measurement);
  /// Model steps between two times, at most longest_gap_steps + 1; 1 without times. A time that goes back belongs to a
  /// clock that was set anew: the filter restarts, as after a long gap.
  static Eigen::Index steps_between(double from_s, double to_s, double dt_s) {
    if (to_s < from_s) return longest_gap_steps + 1;
    const bool near = !(dt_s > 0.0 && to_s - from_s >= 1.25 * dt_s);  // the usual case is decided without a division
    return near ? 1 : whole_steps((to_s - from_s) / dt_s);
  }
  Eigen::Index channels() const { return inputs_; }  ///< m
  /// Forgets all samples.
  void clear() { samples_ = whole_ = 0.0; }

  /// Number of model steps from the previous sample to this one. Above longest_gap_steps, the filter restarts.
  Eigen::Index steps() const { return steps_; }
  /// Whether the filter can start here: all lagged samples must be complete, and all lagged inputs known.
  bool can_start() const { return samples_ >= needed_samples_ && whole_ >= static_cast<double>(measurements_.cols()); }
  /// Data for a start: the measurement. With lags, the measurements of all samples in z.
  auto start() const { return measurements_.reshaped(); }
  /// The acting inputs v of the transition to this sample.
  Eigen::Map<const Eigen::VectorXd> inputs() const {
    return {recent_.data() + inputs_ * latest_delay_, acting_inputs_};
  }

  /// The parts of a snapshot. After they have been written, `settle` throws std::invalid_argument if they are none.
  std::vector<SnapshotPart> parts() {
    return {numbers_of(recent_), numbers_of(measurements_), {&samples_, 1}, {&whole_, 1}, {&time_s_, 1}};
  }
  void settle() const;

 private:
  Eigen::Index inputs_, latest_delay_, acting_inputs_;
  double needed_samples_, dt_s_;
  std::vector<Eigen::Index> ahead_;  ///< m, samples by which an input acts before the latest
  Eigen::MatrixXd recent_;           ///< inputs u[k], u[k-1], ...; u[k] is repeated for inputs that act early
  Eigen::MatrixXd measurements_;     ///< newest first
  double samples_ = 0.0, whole_ = 0.0, time_s_ = 0.0;  ///< counts of all samples and of the last complete ones
  Eigen::Index steps_ = 1;

  static Eigen::Index whole_steps(double periods);
  /// Shifts every column one place back. The first column keeps the newest values.
  static void shift(Eigen::MatrixXd& newest_first) {
    double* column = newest_first.data();
    for (Eigen::Index i = newest_first.size() - 1; i >= newest_first.rows(); --i)
      column[i] = column[i - newest_first.rows()];
  }
};

// Inlined, with plain loops: calls, or Eigen expressions of dynamic size, would take longer than a filter step.
[[gnu::always_inline]] inline void SampleFeed::push(double time_s, const double* input, const double* measurement) {
  steps_ = samples_ == 0.0 ? 1 : steps_between(time_s_, time_s, dt_s_);
  if (steps_ > longest_gap_steps) clear();
  shift(recent_);
  double* newest = recent_.data();
  for (Eigen::Index i = 0; i < inputs_; ++i) {
    if (std::isfinite(input[i])) newest[i] = input[i];  // if the input is missing, its last known value acts
    for (Eigen::Index copy = 1; copy <= ahead_[i]; ++copy) newest[i + copy * inputs_] = newest[i];
  }
  shift(measurements_);
  newest = measurements_.data();
  bool whole = true;
  for (Eigen::Index i = 0; i < measurements_.rows(); ++i) {
    newest[i] = measurement[i];
    whole = whole && !is_missing(measurement[i]);
  }
  whole_ = whole ? whole_ + 1.0 : 0.0;
  samples_ += 1.0;
  time_s_ = time_s;
}

/// Throws std::invalid_argument for sizes that do not fit, DataError for an input that is not finite.
void check_run(const Bank& bank, const Trajectory& run);

/// Time of a sample; NaN for a run without times.
inline double sample_time_s(const Trajectory& run, Eigen::Index k) {
  return run.time_s.size() > 0 ? run.time_s(k) : not_a_number;
}

/// One moment of a filtered run: a sample, or a model step between two distant samples.
struct Instant {
  Eigen::Index sample = -1;    ///< index of the sample; -1 between samples
  bool starts = false;         ///< whether the filter (re)starts here
  Eigen::VectorXd start = {};  ///< measurements for the start; empty at other moments
};

/// All moments of a run from the first start on, with the acting inputs, in the filter's order.
struct RunInstants {
  std::vector<Instant> instants;
  Eigen::MatrixXd inputs;  ///< m x instants; column t acts on the step to moment t

  RunInstants(const Bank& bank, const Trajectory& run);
  Eigen::Index count() const { return std::ssize(instants); }
  /// Whether the moment after t belongs to the same stretch.
  bool continues(Eigen::Index t) const { return t + 1 < count() && !instants[t + 1].starts; }
};

/// Advances a filter to moment t of a run. Returns the log density of the sample; NaN without one.
template <class Filter>
double follow(const RunInstants& run, Eigen::Index t, const Trajectory& trajectory, Filter& filter) {
  const Instant& instant = run.instants[t];
  if (instant.sample >= 0 && !instant.starts) {
    filter.predict(run.inputs.col(t));
    return filter.update(trajectory.state.col(instant.sample));
  }
  if (instant.starts)
    filter.start(instant.start);
  else
    filter.step(run.inputs.col(t));
  return not_a_number;
}

}  // namespace modebank
