#pragma once

#include <Eigen/Core>

#include "ident/data/streams.hpp"

namespace modebank {

/// A stream as a function of continuous time, with exact averages over any interval. States are linear between samples.
/// Inputs are held from each sample to the next. They then pass a first-order lag, time_constant_s * f' = u - f, with f
/// = u at the first sample. Intervals must be in increasing order, so N averages cost O(N + samples).
class AveragedStream {
 public:
  static AveragedStream linear(const Stream& stream);
  static AveragedStream held(const Stream& stream, double time_constant_s);

  Eigen::Index channels() const { return values_.rows(); }
  double first_s() const { return time_s_(0); }
  double last_s() const { return time_s_(time_s_.size() - 1); }
  /// Mean over [centre - width/2, centre + width/2] for each centre, channels x N. Outside the stream's span, a linear
  /// stream keeps its end value and a held stream its last sample.
  Eigen::MatrixXd mean(const Eigen::VectorXd& centres_s, double width_s) const;

 private:
  void integral(double time_s, Eigen::Index& sample, Eigen::VectorXd& result) const;

  bool held_ = false;
  double time_constant_s_ = 0.0;
  Eigen::VectorXd time_s_;
  Eigen::MatrixXd values_;    // channels x N
  Eigen::MatrixXd filtered_;  // output of the first-order lag at the samples (held streams only)
  Eigen::MatrixXd integral_;  // integral from the first sample to each sample
};

}  // namespace modebank
