#pragma once

#include <Eigen/Core>

#include "filter/step/bank_filter.hpp"

namespace modebank {

/// What a live sample means beside its estimate.
struct LiveVerdict {
  Eigen::VectorXd predicted;     ///< n_y, measurement that was expected
  Eigen::VectorXd lower, upper;  ///< n_y, where it was expected: +- quantile * sqrt(S_ii), by the mixture's moments
  bool alarm = false;            ///< some signal came out further than `alarm` of a true filter's would
};

/// Judges samples by the filter's own uncertainty. The alarm goes by the probability transform, which unlike NIS has
/// the same meaning for every mixture: it is false on 1 - `alarm` of the samples of a true filter of one signal.
class LiveJudge {
 public:
  explicit LiveJudge(const Bank& bank);
  /// Allocates nothing.
  const LiveVerdict& judge(const FilterEstimate& estimate);

 private:
  Eigen::MatrixXd C_;
  double interval_quantile_;
  LiveVerdict verdict_;
};

}  // namespace modebank
