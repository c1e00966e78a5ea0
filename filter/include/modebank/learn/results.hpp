#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "modebank/base/names.hpp"

namespace modebank {

/// How a maximisation of the likelihood of a filter with measurement noise ended. none: not done, or its result was
/// rejected. converged: at the maximum. iteration_limit: stopped before the maximum. stalled: no step raised the
/// likelihood although the gradient was not zero.
enum class MeasuredFit { none, converged, iteration_limit, stalled };

template <>
struct EnumNames<MeasuredFit> {
  static constexpr Names<4> values{"none", "converged", "iteration_limit", "stalled"};
};

/// One row of the cross-validation inside the training runs. Scores are NaN without cross-validation.
struct RefineCandidate {
  std::string start;                                        ///< "mixture" or "stretches 1"
  std::ptrdiff_t modes = 0;                                 ///< number of modes of the start
  std::ptrdiff_t iterations = 0;                            ///< of expectation-maximisation
  double score = std::numeric_limits<double>::quiet_NaN();  ///< mean log score of the left-out runs [nats/sample]
  double loss = std::numeric_limits<double>::quiet_NaN();   ///< against the best row, on the same runs [nats/sample]
  /// Clustered by run; by stretch if there are fewer than three runs.
  double loss_standard_error = std::numeric_limits<double>::quiet_NaN();
  bool selected = false;  ///< whether the bank comes from this row
};

/// The fit with measurement noise, if it is not small.
struct MeasurementStage {
  std::ptrdiff_t iterations = 0;        ///< with measurement noise; 0 if none were made or their result was rejected
  MeasuredFit end = MeasuredFit::none;  ///< how these iterations ended
  /// Mean log score of the left-out runs before and after these iterations; NaN without cross-validation or R. Before:
  /// NaN where motions were tried with R, each with a row of its own.
  double score_before = std::numeric_limits<double>::quiet_NaN();
  double score = std::numeric_limits<double>::quiet_NaN();  ///< after them
};

/// Whether transition probabilities depend on state and input, by cross-validation inside the training runs.
struct SwitchingStage {
  double width = 0.0;  ///< prior standard deviation of the weights, in those of the regressors; 0: no dependence
  /// Mean log score of the left-out runs with constant T, and the gain of the logit with its standard error by run
  /// [nats/sample]; NaN if it was not tested.
  double score_before = std::numeric_limits<double>::quiet_NaN();
  double gain = std::numeric_limits<double>::quiet_NaN();                 ///< of the logit
  double gain_standard_error = std::numeric_limits<double>::quiet_NaN();  ///< by run
};

}  // namespace modebank
