#pragma once

#include <Eigen/Core>

#include "filter/step/bank_filter.hpp"

namespace modebank {

/// Verdict about a live sample, in addition to its estimate.
struct LiveVerdict {
  Eigen::VectorXd predicted;     ///< n_y, predicted measurement
  Eigen::VectorXd lower, upper;  ///< n_y, predicted interval: +- quantile * sqrt(S_ii), by the moments of the mixture
  bool alarm = false;            ///< whether some signal lies in one of the tails, whose total probability is `alarm`
};

/// Judges samples by the filter's own uncertainty. The alarm uses the probability transform, which has the same
/// distribution for every mixture; the NIS does not. If the model is correct and has one signal, the expected share of
/// samples with an alarm is `alarm`.
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
