#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "modebank/base/names.hpp"

namespace modebank {

/// How a maximisation of the filter's likelihood with measurement noise ended. none: there was none, or it did not pay.
/// iteration_limit: that came before the maximum. stalled: no step raised the likelihood though its gradient promised
/// more.
enum class MeasuredFit { none, converged, iteration_limit, stalled };

template <>
struct EnumNames<MeasuredFit> {
  static constexpr Names<4> values{"none", "converged", "iteration_limit", "stalled"};
};

/// One row of the cross-validation inside the training runs.
struct RefineCandidate {
  std::string start;               ///< "mixture" or "stretches 1"
  std::ptrdiff_t modes = 0;        ///< of the start
  double noise_transitions = 0.0;  ///< how many transitions the prior on Q is worth
  std::ptrdiff_t iterations = 0;   ///< of expectation-maximisation
  double score =
      std::numeric_limits<double>::quiet_NaN();  ///< mean log score of the runs left out, nats per sample; NaN without
  double loss = std::numeric_limits<double>::quiet_NaN();  ///< against the best row on the same runs, nats per sample
  double loss_standard_error =
      std::numeric_limits<double>::quiet_NaN();  ///< of it, clustered by run (by stretch where fewer than three)
  bool selected = false;                         ///< the bank is of it
  double theta_transitions = 0.0;                ///< at one motion, that its theta is drawn by
};

/// How the search for R went, and the fit once R was known to be more than nothing.
struct MeasurementStage {
  std::ptrdiff_t starts = 0;            ///< of the search for R; 0: R was given
  std::ptrdiff_t failed_starts = 0;     ///< of these, from which there was no way up; the best of the others counts
  std::ptrdiff_t iterations = 0;        ///< with measurement noise; 0: there is none, or they would not have paid
  MeasuredFit end = MeasuredFit::none;  ///< how they ended
  double score_before = std::numeric_limits<double>::quiet_NaN();  ///< mean log score of the runs left out
  double score = std::numeric_limits<double>::quiet_NaN();  ///< the same after them; NaN without cross-validation or R
  double seconds = 0.0;                                     ///< wall time of all this
};

/// Whether switches see state and input, by cross-validation inside the training runs.
struct SwitchingStage {
  double width = 0.0;  ///< prior standard deviation of the weights in units of the regressors' spread; 0: they do not
  double memory_sd = std::numeric_limits<double>::infinity();      ///< prior of what the mode before adds to log odds
  double score_before = std::numeric_limits<double>::quiet_NaN();  ///< mean log score of the runs left out, constant T
  double gain = std::numeric_limits<double>::quiet_NaN();  ///< of the logit over it, nats per sample; NaN: not asked
  double gain_standard_error = std::numeric_limits<double>::quiet_NaN();  ///< clustered by run
};

/// Whether modes drift, by cross-validation inside the training runs.
struct DriftStage {
  bool taken = false;        ///< whether the bank's modes drift
  std::ptrdiff_t modes = 0;  ///< of the bank that drifts best
  double rate = 0.0;   ///< of that bank: variance that a step adds to every coefficient, in units of the mode's noise
                       ///< and of regressors divided by their root mean square
  double start = 0.0;  ///< of it: variance of every coefficient at a run's start
  double leak = 1.0;   ///< of it: what a step leaves of the difference from the mode's
  double score_before = std::numeric_limits<double>::quiet_NaN();  ///< mean log score of the runs left out, no drift
  double gain = std::numeric_limits<double>::quiet_NaN();          ///< of the drift, nats per sample; NaN: not asked
  double gain_standard_error = std::numeric_limits<double>::quiet_NaN();  ///< clustered by run
};

}  // namespace modebank
