#pragma once

#include <Eigen/Core>

#include "filter/step/bank_filter.hpp"

namespace modebank {

/// Verdict about a live sample, besides its estimate.
struct LiveVerdict {
  Eigen::VectorXd predicted;     ///< n_y, predicted measurement
  Eigen::VectorXd lower, upper;  ///< n_y, predicted interval: +- quantile * sqrt(S_ii), by the mixture's moments
  bool alarm = false;            ///< whether some signal lies in the outermost `alarm` share of the prediction
};

/// Judges samples by the filter's own uncertainty. The alarm uses the probability transform, which has the same meaning
/// for every mixture, unlike NIS. A true filter of one signal gives an alarm on a share `alarm` of its samples.
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
