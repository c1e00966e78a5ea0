#pragma once

#include <Eigen/Core>

#include "filter/step/bank.hpp"
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
  SampleFeed(const Bank& bank, TimeSteps time_steps);

  /// The next sample: its time (NaN: one step after the last), the input recorded at it (m) and the measurement (n_y).
  void push(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
            const Eigen::Ref<const Eigen::VectorXd>& measurement);
  /// Model steps from one time to the next, at most longest_gap_steps + 1; 1 when there is no clock.
  static Eigen::Index steps_between(double from_s, double to_s, double dt_s, TimeSteps time_steps);
  /// Forgets all samples.
  void clear();

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
  TimeSteps time_steps_;
  double dt_s_;
  Eigen::MatrixXd recent_;        ///< inputs u[k], u[k-1], ...; those that act end it
  Eigen::MatrixXd measurements_;  ///< newest first
  Eigen::Index samples_ = 0, whole_ = 0, steps_ = 1;
  double time_s_ = 0.0;
};

}  // namespace modebank
