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

/// One row of the cross-validation inside the training runs.
struct RefineCandidate {
  std::string start;                                        ///< start: "mixture" or "stretches 1"
  std::ptrdiff_t modes = 0;                                 ///< number of modes of the start
  double noise_transitions = 0.0;                           ///< weight of the prior on Q, in transitions
  std::ptrdiff_t iterations = 0;                            ///< number of iterations of expectation-maximisation
  double score = std::numeric_limits<double>::quiet_NaN();  ///< mean log score of the runs that were left out
                                                            ///< [nats/sample]; NaN without cross-validation
  double loss = std::numeric_limits<double>::quiet_NaN();   ///< loss against the best row, on the same runs
                                                            ///< [nats/sample]
  double loss_standard_error = std::numeric_limits<double>::quiet_NaN();  ///< standard error of the loss, clustered by
                                                                          ///< run; by stretch if there are fewer than
                                                                          ///< three runs
  bool selected = false;                                                  ///< whether the bank comes from this row
};

/// The search for R, and the fit with R if it is not negligible.
struct MeasurementStage {
  std::ptrdiff_t starts = 0;            ///< number of starts of the search for R; 0 if R was given
  std::ptrdiff_t failed_starts = 0;     ///< number of starts from which no step raised the likelihood; the best of the
                                        ///< other starts is kept
  std::ptrdiff_t iterations = 0;        ///< number of iterations with measurement noise; 0 if none were made or their
                                        ///< result was rejected
  MeasuredFit end = MeasuredFit::none;  ///< how these iterations ended
  double score_before = std::numeric_limits<double>::quiet_NaN();  ///< mean log score of the left-out runs before these
                                                                   ///< iterations
  double score = std::numeric_limits<double>::quiet_NaN();         ///< mean log score of the left-out runs after these
                                                                   ///< iterations; NaN without cross-validation or R
  double seconds = 0.0;                                            ///< wall time of this stage
};

/// Whether transition probabilities depend on state and input, by cross-validation inside the training runs.
struct SwitchingStage {
  double width = 0.0;  ///< prior standard deviation of the weights, in units of the regressors' standard deviation; 0
                       ///< means no dependence
  double score_before = std::numeric_limits<double>::quiet_NaN();  ///< mean log score of the left-out runs with
                                                                   ///< constant T
  double gain = std::numeric_limits<double>::quiet_NaN();  ///< gain of the logit over constant T [nats/sample]; NaN if
                                                           ///< it was not tested
  double gain_standard_error = std::numeric_limits<double>::quiet_NaN();  ///< standard error of the gain, clustered by
                                                                          ///< run
};

}  // namespace modebank
