#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/fit/loss.hpp"

namespace modebank {

/// Distribution of the one-step errors of one robust model over all runs.
struct TailCheck {
  Eigen::Index transitions = 0;
  double beyond_four = 0.0;   ///< share of errors beyond 4 robust standard deviations (normal: 6.3e-5)
  double beyond_eight = 0.0;  ///< share of errors beyond 8 robust standard deviations
};
TailCheck check_tails(const Recording& recording, const LinearStructure& structure);

struct LengthAdvice {
  Eigen::Index length = 0;
  double deficient = 0.0;  ///< share of rank-deficient windows of this length
  bool enough = false;     ///< whether at most a fifth of the windows is rank deficient
};
/// Shortest length at which at most a fifth of the windows is rank deficient. The lengths form a fixed series and have
/// at least 8 transitions per regressor. If no length satisfies this, returns the shortest length whose share is within
/// 0.1 of the smallest share. Ignores lengths for which half of the runs are too short.
LengthAdvice advise_length(const std::vector<Trajectory>& runs, const LinearStructure& structure);

struct LossAdvice {
  Loss loss = Loss::huber;
  TailCheck tails;
};
/// Recommends a loss. `trivial`: fewer than 0.1 % of the errors lie beyond 4 robust standard deviations. `tukey`: more
/// than 1 % of the errors lie beyond 8 robust standard deviations (gross errors). Otherwise `huber`.
LossAdvice advise_loss(const Recording& recording, const LinearStructure& structure);

/// Reason for a recommended rate.
enum class RateReason { keep, jitter, repeats, too_fast, too_slow };

struct RateFacts {
  double inputs_hz = 0.0;  ///< median rate
  double states_hz = 0.0;
  double jitter = 0.0;           ///< standard deviation of the intervals between input samples, as a share of the
                                 ///< median interval
  double repeated = 0.0;         ///< share of repeated values of a measured input; 0 if the inputs are commands
  double time_constant_s = 0.0;  ///< time constant of the response; 0 if it is unknown
};
struct RateAdvice {
  double rate_hz = 0.0;  ///< value for data.rate_hz; 0 keeps the inputs' own times
  RateReason reason = RateReason::keep;
};
/// Recommends a sample rate. Two to thirty samples per time constant of the response are good. Faster data are reduced
/// to ten samples per time constant. Slower data are raised to five if the states are sampled fast enough. If the
/// jitter is above a fifth of a period, resampling at the median rate is recommended. If an encoder repeats at least 30
/// % of its samples, the rate at which its values change is recommended. The rate is a whole multiple or a whole
/// fraction of the inputs' rate, so that predictions at both rates can be compared at the same times.
RateAdvice advise_rate(const RateFacts& facts);

}  // namespace modebank
