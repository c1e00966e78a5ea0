#pragma once

#include <Eigen/Core>
#include <cmath>

#include "filter/step/bank.hpp"
#include "filter/step/equations/bounds.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// After this many steps without a sample a filter starts anew from the next whole measurement: what it knew has
/// decayed, and predictions of an input held for so long say nothing.
inline constexpr Eigen::Index longest_gap_steps = 50;

/// Turns samples in the order of time into what a filter steps on: the inputs that act on the transition into each
/// sample, lagged ones among them, how many model steps that transition takes, and the start. Allocates nothing after
/// construction.
class SampleFeed {
 public:
  explicit SampleFeed(const Bank& bank);

  /// The next sample: its time (NaN: one step after the last), the input recorded at it (m) and the measurement (n_y).
  void push(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
            const Eigen::Ref<const Eigen::VectorXd>& measurement);
  /// The same of m inputs and n_y measurements that nobody counts again.
  void push(double time_s, const double* input, const double* measurement);
  /// Model steps from one time to the next, at most longest_gap_steps + 1; 1 when there is no clock.
  static Eigen::Index steps_between(double from_s, double to_s, double dt_s) {
    const bool near = !(dt_s > 0.0 && to_s - from_s >= 1.25 * dt_s);  // nearly always, and it takes no division
    return near ? 1 : whole_steps((to_s - from_s) / dt_s);
  }
  /// Forgets all samples.
  void clear() { samples_ = whole_ = 0; }

  /// Model steps from the sample before to this one; more than longest_gap_steps: start anew.
  Eigen::Index steps() const { return steps_; }
  /// Whether the filter can start at this sample: it and every lagged sample are whole, and all lagged inputs are
  /// known.
  bool can_start() const { return samples_ > first_transition_ && whole_ >= measurements_.cols(); }
  /// What it starts from: the measurement, with lags the measurements of all of z.
  auto start() const { return measurements_.reshaped(); }
  /// The acting inputs v of the transition into this sample.
  Eigen::Map<const Eigen::VectorXd> inputs() const { return {recent_.data() + inputs_ * input_delay_, acting_inputs_}; }

  /// What is remembered between samples, for checkpoints.
  struct Memory {
    Eigen::MatrixXd inputs;        ///< m x depth, newest first
    Eigen::MatrixXd measurements;  ///< n_y x state lags, newest first
    Eigen::Index samples = 0, whole = 0;
    double time_s = 0.0;
  };
  Memory memory() const { return {recent_, measurements_, samples_, whole_, time_s_}; }
  /// Throws std::invalid_argument when sizes disagree.
  void restore(const Memory& memory);

 private:
  Eigen::Index inputs_, input_delay_, acting_inputs_, first_transition_;
  double dt_s_;
  Eigen::MatrixXd recent_;        ///< inputs u[k], u[k-1], ...; those that act end it
  Eigen::MatrixXd measurements_;  ///< newest first
  Eigen::Index samples_ = 0, whole_ = 0, steps_ = 1;
  double time_s_ = 0.0;

  static Eigen::Index whole_steps(double periods);
  /// Every column takes the place of the one after it; the newest stays in the first.
  static void shift(Eigen::MatrixXd& newest_first) {
    double* column = newest_first.data();
    for (Eigen::Index i = newest_first.size() - 1; i >= newest_first.rows(); --i)
      column[i] = column[i - newest_first.rows()];
  }
};

// Inline and in plain loops: a filter's step takes less time than calls, and Eigen's expressions of sizes that it does
// not know.
[[gnu::always_inline]] inline void SampleFeed::push(double time_s, const double* input, const double* measurement) {
  steps_ = samples_ == 0 ? 1 : steps_between(time_s_, time_s, dt_s_);
  if (steps_ > longest_gap_steps) clear();
  shift(recent_);
  double* newest = recent_.data();
  for (Eigen::Index i = 0; i < inputs_; ++i)
    if (std::isfinite(input[i])) newest[i] = input[i];  // else the last known one still acts
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
