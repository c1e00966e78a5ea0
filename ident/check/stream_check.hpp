#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/streams.hpp"

namespace modebank {

/// Sampling of one stream as recorded. Times may repeat, go backwards or be missing (NaN).
struct SamplingCheck {
  Eigen::Index samples = 0;
  double duration_s = 0.0;  ///< largest minus smallest time
  double rate_hz = 0.0;     ///< 1 / median interval; 0 if it is unknown
  double jitter = 0.0;      ///< standard deviation of the intervals (without gaps), as a share of the median interval
  Eigen::Index gaps = 0;    ///< intervals longer than gap_periods median intervals
  double longest_gap_s = 0.0;
  Eigen::Index repeated_times = 0;
  Eigen::Index backward_times = 0;
  Eigen::Index missing_times = 0;
  Eigen::Index missing_samples = 0;  ///< samples with at least one missing value
  double repeated_samples = 0.0;     ///< share of samples whose values all equal those of the previous sample
};

SamplingCheck check_sampling(const Stream& recorded);

/// The usable part of a recorded stream: samples without a time are removed, the rest is sorted, with one sample per
/// time.
Stream in_order(const Stream& recorded);

/// Figures of one signal of a stream. Missing values are ignored.
struct ChannelCheck {
  Eigen::Index missing = 0;
  double least = 0.0, largest = 0.0, mean = 0.0, sd = 0.0;
  double quantum = 0.0;  ///< spacing of the lattice that contains all values; 0 if no spacing is above a thousandth of
                         ///< the range
  Eigen::Index levels = 0;    ///< distinct values
  bool two_level = false;     ///< see has_two_levels()
  double repeated = 0.0;      ///< share of samples that equal the previous sample
  Eigen::Index outliers = 0;  ///< number of isolated outliers (see `spikes`)
};

ChannelCheck check_channel(const Eigen::VectorXd& values);

/// Whether a signal is a switch or a binary test signal. At least 99 % of its known values must lie within a tenth of
/// the levels' distance from one of two levels. A level is the mean of its values and must have at least 2 % of all
/// values.
bool has_two_levels(const Eigen::VectorXd& values);

/// Number of isolated outliers. An outlier differs from both neighbours in the same direction. Consider its distance
/// from the mean of the two neighbours. This distance exceeds three limits: 12 robust standard deviations of such
/// distances in the surrounding 51 samples, three quanta, and 1 % of the range.
Eigen::Index spikes(const Eigen::VectorXd& values, double quantum);

/// Detects the ends of a signal's range at which a limiter acts. Full scale is the largest absolute value over all
/// runs. Ends below 0.8 of full scale are ignored.
/// - Hard limit: the outermost 2 % of the range hold more than 0.5 % of the samples, and more than 1.5 times the
///   number in the next 4 %.
/// - Soft limit: the outermost fifth of full scale holds more than 2 % of the samples that differ from the previous
///   one, and more than 1.2 times the number in the next fifth. Samples in the outer half of that fifth then count as
///   saturated.
/// - Each excess must be at least three standard errors of the counts, where held values count once.
/// - Two-level signals have no limits. A signal of up to ten levels has a limit only at an end with three times the
///   share of the commonest inner level. Test signals and gears often take each of a few values.
struct SaturationLimits {
  /// Samples at or below low, or at or above high, count as saturated; NaN at an end without a limit.
  double low, high;
  bool soft = false;  ///< true: no hard limit was found, but a soft one
};
SaturationLimits saturation_limits(const std::vector<Eigen::VectorXd>& runs);

}  // namespace modebank
