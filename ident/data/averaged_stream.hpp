#pragma once

#include <Eigen/Core>

#include "ident/data/streams.hpp"

namespace modebank {

/// A stream as a function of continuous time that can be averaged over any interval exactly: linear between samples
/// (states), or held from each sample to the next (inputs) and passed through a first-order lag
/// time_constant_s * f' = u - f, f = u at the first sample. Averages need the interval's ends in increasing order, so
/// that N of them cost O(N + samples).
class AveragedStream {
 public:
  static AveragedStream linear(const Stream& stream);
  static AveragedStream held(const Stream& stream, double time_constant_s);

  Eigen::Index channels() const { return values_.rows(); }
  double first_s() const { return time_s_(0); }
  double last_s() const { return time_s_(time_s_.size() - 1); }
  /// channels x N: the mean over [centre - width/2, centre + width/2] of each centre. Beyond the stream's span a linear
  /// stream keeps its end's value, a held one its last sample.
  Eigen::MatrixXd mean(const Eigen::VectorXd& centres_s, double width_s) const;

 private:
  void integral(double time_s, Eigen::Index& sample, Eigen::VectorXd& result) const;

  bool held_ = false;
  double time_constant_s_ = 0.0;
  Eigen::VectorXd time_s_;
  Eigen::MatrixXd values_;    // channels x N
  Eigen::MatrixXd filtered_;  // the first-order lag's output at the samples (held only)
  Eigen::MatrixXd integral_;  // from the first sample on
};

}  // namespace modebank
