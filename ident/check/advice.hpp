#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/fit/loss.hpp"

namespace modebank {

/// Distribution of the one-step errors of one robust model over all runs.
struct TailCheck {
  Eigen::Index transitions = 0;
  double beyond_four = 0.0;   ///< share beyond 4 robust standard deviations (normal: 6.3e-5)
  double beyond_eight = 0.0;  ///< share beyond 8
};
TailCheck check_tails(const Recording& recording, const LinearStructure& structure);

struct LengthAdvice {
  Eigen::Index length = 0;
  double deficient = 0.0;  ///< share of rank-deficient windows at that length
  bool enough = false;     ///< whether at most a fifth are
};
/// Shortest of a ladder of lengths (at least 8 transitions per regressor) at which at most a fifth of the windows is
/// rank deficient; when none is, the shortest within 0.1 of the least share. Lengths that half of the runs cannot hold
/// are not considered.
LengthAdvice advise_length(const std::vector<Trajectory>& runs, const LinearStructure& structure);

struct LossAdvice {
  Loss loss = Loss::huber;
  TailCheck tails;
};
/// trivial below 0.1 % beyond 4 robust standard deviations, tukey above 1 % beyond 8 (gross errors), else huber.
LossAdvice advise_loss(const Recording& recording, const LinearStructure& structure);

/// Why a rate is suggested.
enum class RateReason { keep, jitter, repeats, too_fast, too_slow };

struct RateFacts {
  double inputs_hz = 0.0;  ///< median rate
  double states_hz = 0.0;
  double jitter = 0.0;           ///< of the inputs' intervals, in median ones
  double repeated = 0.0;         ///< share of repeated values of a measured input; 0 when inputs are commands
  double time_constant_s = 0.0;  ///< of the response; 0: unknown
};
struct RateAdvice {
  double rate_hz = 0.0;  ///< for data.rate_hz; 0: keep the inputs' own times
  RateReason reason = RateReason::keep;
};
/// Two to thirty samples per time constant are fine; faster data are brought to ten, slower ones to five as long as
/// the states are sampled fast enough for it. Jitter above a fifth of a period asks for resampling at the median rate;
/// an encoder that repeats at least 30 % of its samples for the rate of its changes. The rate is a whole multiple or
/// fraction of the inputs' own, so that what is predicted at both can be compared at the same instants.
RateAdvice advise_rate(const RateFacts& facts);

}  // namespace modebank
