#pragma once

#include <Eigen/Core>

#include "filter/step/bank_filter.hpp"

namespace modebank {

/// Verdict about a live sample, in addition to its estimate.
struct LiveVerdict {
  Eigen::VectorXd predicted;     ///< n_y, predicted measurement
  Eigen::VectorXd lower, upper;  ///< n_y, predicted interval: +- quantile * sqrt(S_ii), by the moments of the mixture
  bool alarm = false;            ///< whether some signal lies in the outermost `alarm` share of the prediction
};

/// Judges samples by the filter's own uncertainty. The alarm uses the probability transform, whose meaning is the same
/// for every mixture, unlike that of NIS. If the model is correct and has one signal, a share `alarm` of the samples
/// gives an alarm.
class LiveJudge {
 public:
  explicit LiveJudge(const Bank& bank);
  /// Judges one sample; does not allocate.
  const LiveVerdict& judge(const FilterEstimate& estimate);

 private:
  Eigen::MatrixXd C_;
  double interval_quantile_;
  LiveVerdict verdict_;
};

}  // namespace modebank
