#pragma once

#include <Eigen/Core>
#include <cmath>
#include <tuple>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/equations/bounds.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// If more steps than this pass without a sample, a filter restarts at the next complete measurement. Its state is
/// outdated by then, and predictions with an input held for so long are worthless.
inline constexpr Eigen::Index longest_gap_steps = 50;

/// Converts samples in time order to the inputs of a filter step. These are the acting inputs of the transition to each
/// sample (with lags), the number of model steps, and whether the filter starts. Allocates only at construction.
class SampleFeed {
 public:
  explicit SampleFeed(const Bank& bank);

  /// Adds the next sample: time (NaN: one step after the last sample), input (m) and measurement (n_y).
  void push(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
            const Eigen::Ref<const Eigen::VectorXd>& measurement);
  /// Like `push`, but without checks of the sizes (m inputs, n_y measurements).
  void push(double time_s, const double* input, const double* measurement);
  /// Number of model steps between two times, at most longest_gap_steps + 1. Without times it is 1. A time that goes
  /// back belongs to a clock that was set anew: the filter restarts, as after a long gap.
  static Eigen::Index steps_between(double from_s, double to_s, double dt_s) {
    if (to_s < from_s) return longest_gap_steps + 1;
    const bool near = !(dt_s > 0.0 && to_s - from_s >= 1.25 * dt_s);  // the usual case is decided without a division
    return near ? 1 : whole_steps((to_s - from_s) / dt_s);
  }
  Eigen::Index channels() const { return inputs_; }  ///< m
  /// Forgets all samples.
  void clear() { samples_ = whole_ = 0; }

  /// Number of model steps from the previous sample to this one. Above longest_gap_steps, the filter restarts.
  Eigen::Index steps() const { return steps_; }
  /// Whether the filter can start at this sample. The sample and all lagged samples must be complete, and all lagged
  /// inputs known.
  bool can_start() const { return samples_ > first_transition_ && whole_ >= measurements_.cols(); }
  /// Data for a start: the measurement. With lags, the measurements of all samples in z.
  auto start() const { return measurements_.reshaped(); }
  /// The acting inputs v of the transition to this sample.
  Eigen::Map<const Eigen::VectorXd> inputs() const {
    return {recent_.data() + inputs_ * latest_delay_, acting_inputs_};
  }

  /// The parts of a snapshot. After they have been read, `settle` checks them.
  auto parts() { return std::tie(recent_, measurements_, samples_, whole_, time_s_); }
  auto parts() const { return std::tie(recent_, measurements_, samples_, whole_, time_s_); }
  /// Throws std::invalid_argument if they cannot be those of a feed.
  void settle() const;

 private:
  Eigen::Index inputs_, latest_delay_, acting_inputs_, first_transition_;
  double dt_s_;
  std::vector<Eigen::Index> ahead_;  ///< m, samples by which an input acts before the latest
  Eigen::MatrixXd recent_;           ///< inputs u[k], u[k-1], ...; u[k] is repeated for inputs that act early, so that
                                     ///< the last columns are the acting inputs
  Eigen::MatrixXd measurements_;     ///< newest first
  Eigen::Index samples_ = 0, whole_ = 0, steps_ = 1;
  double time_s_ = 0.0;

  static Eigen::Index whole_steps(double periods);
  /// Shifts every column one place back. The first column keeps the newest values.
  static void shift(Eigen::MatrixXd& newest_first) {
    double* column = newest_first.data();
    for (Eigen::Index i = newest_first.size() - 1; i >= newest_first.rows(); --i)
      column[i] = column[i - newest_first.rows()];
  }
};

// Inlined, with plain loops. Function calls, or Eigen expressions of dynamic size, would take longer than a filter
// step.
[[gnu::always_inline]] inline void SampleFeed::push(double time_s, const double* input, const double* measurement) {
  steps_ = samples_ == 0 ? 1 : steps_between(time_s_, time_s, dt_s_);
  if (steps_ > longest_gap_steps) clear();
  shift(recent_);
  double* newest = recent_.data();
  for (Eigen::Index i = 0; i < inputs_; ++i) {
    if (std::isfinite(input[i])) newest[i] = input[i];  // if the input is missing, its last known value acts
    const Eigen::Index ahead = ahead_[static_cast<std::size_t>(i)];
    for (Eigen::Index copy = 1; copy <= ahead; ++copy) newest[i + copy * inputs_] = newest[i];
  }
  shift(measurements_);
  newest = measurements_.data();
  bool whole = true;
  for (Eigen::Index i = 0; i < measurements_.rows(); ++i) {
    newest[i] = measurement[i];
    whole = whole && !is_missing(measurement[i]);
  }
  whole_ = whole ? whole_ + 1 : 0;
  ++samples_;
  time_s_ = time_s;
}

}  // namespace modebank
