#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/streams.hpp"

namespace modebank {

/// Sampling of one stream as recorded: times may repeat, go backwards or be missing (NaN).
struct SamplingCheck {
  Eigen::Index samples = 0;
  double duration_s = 0.0;  ///< largest minus smallest time
  double rate_hz = 0.0;     ///< 1 / median interval; 0: unknown
  double jitter = 0.0;      ///< standard deviation of the intervals without gaps, in median intervals
  Eigen::Index gaps = 0;    ///< intervals longer than gap_periods median ones
  double longest_gap_s = 0.0;
  Eigen::Index repeated_times = 0;
  Eigen::Index backward_times = 0;
  Eigen::Index missing_times = 0;
  Eigen::Index missing_samples = 0;  ///< with at least one missing value
  double repeated_samples = 0.0;     ///< share of samples whose values all equal those of the one before
};

SamplingCheck check_sampling(const Stream& recorded);

/// What can be relied on of a recorded stream: in order of time, one sample per time, none without time.
Stream in_order(const Stream& recorded);

/// One signal of a stream; missing values are left out.
struct ChannelCheck {
  Eigen::Index missing = 0;
  double least = 0.0, largest = 0.0, mean = 0.0, sd = 0.0;
  double quantum = 0.0;     ///< all values are multiples of this apart; 0: none coarser than a thousandth of the range
  Eigen::Index levels = 0;  ///< distinct values
  bool two_level = false;   ///< see has_two_levels()
  double repeated = 0.0;    ///< share of samples equal to the one before
  Eigen::Index outliers = 0;  ///< isolated samples: see spikes()
};

ChannelCheck check_channel(const Eigen::VectorXd& values);

/// Whether a signal is a switch or a binary test signal: 99 % of its known values lie within a tenth of the distance
/// between two levels from one of them (their means), and each level has 2 % of the values at least.
bool has_two_levels(const Eigen::VectorXd& values);

/// Samples that leave both neighbours in the same direction and stand off their mean by more than 12 robust standard
/// deviations of such distances in the 51 samples around, three quanta and 1 % of the range.
Eigen::Index spikes(const Eigen::VectorXd& values, double quantum);

/// Where a signal presses against an end of its range, as a limiter makes it. Full scale is its largest absolute value
/// over all runs; ends below 0.8 of that are none. Hard: more than 0.5 % of the samples lie in the outermost 2 % of the
/// range, and more than 1.5 times as many as in the next 4 %. Soft: the outermost fifth of full scale holds more than 2
/// % of the samples that do not repeat the one before, and more than 1.2 times as many as the next fifth; its outer
/// half then counts. More: by three standard errors of counts, in which values that are held count once. A signal of
/// two levels has none, and one of up to ten levels only where an end has three times the share of the commonest level
/// inside the range: test signals and gears take each of few values often.
struct SaturationLimits {
  double low, high;   ///< samples at or below low, or at or above high, count as saturated; NaN: no such end
  bool soft = false;  ///< no hard end was found, but a soft one
};
SaturationLimits saturation_limits(const std::vector<Eigen::VectorXd>& runs);

}  // namespace modebank
