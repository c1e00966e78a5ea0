#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "filter/judge/statistics.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// Verdict about a filter's stated uncertainty, from the share of samples outside its 95 % band. If the model is
/// correct, 5 % lie outside.
/// - overconfident: more than 6 % lie outside, and more than 5 % with 99 % confidence.
/// - underconfident: fewer than 2.5 % lie outside, and fewer than 5 % with 99 % confidence. Or fewer than 5 % lie
///   outside, and more than 4 % lie in the central band that should hold 2.5 % (too_close), with 95 % confidence.
/// - calibrated: 2.5 to 7.5 % lie outside, 1 to 4 % lie too close, and neither interval contains its whole band. The
///   mean NIS per signal lies in 0.75 to 1.3, and the lag-1 autocorrelation of each signal's z within +- 0.2. At each
///   of these limits a prediction loses 0.02 nats.
/// - undecided: all other cases, such as a few hundred samples.
/// If the filter is neither overconfident nor underconfident by these rules, the mean NIS decides. It must lie outside
/// the 99 % interval for a correct model and differ from the expected mean by more than a tenth. This rule holds only
/// if every prediction is one Gaussian of known variance. Otherwise (mixture, running noise) the NIS is not chi-square
/// and decides nothing here.
///
/// Autocorrelated samples count as fewer independent samples. Their number follows from an autocorrelation time with a
/// margin for its own error. Two times are computed: from the band's misses, and from the sizes of all samples. The
/// second is needed because short runs have few misses. The longer time is used.
enum class Calibration { undecided, calibrated, overconfident, underconfident };

/// The number that decides a verdict. none: every number passes (calibrated). band: share inside the 95 % band. close:
/// share near the middle of the band. nis: mean NIS. pattern: lag-1 autocorrelation. few_samples: an interval is wider
/// than the calibrated band.
enum class CalibrationReason { none, band, close, nis, pattern, few_samples };

template <>
struct EnumNames<Calibration> {
  static constexpr Names<4> values{"undecided", "calibrated", "overconfident", "underconfident"};
};
template <>
struct EnumNames<CalibrationReason> {
  static constexpr Names<6> values{"none", "band", "close", "NIS", "pattern", "few samples"};
};

struct Verdict {
  Calibration calibration = Calibration::undecided;
  CalibrationReason reason = CalibrationReason::few_samples;
};

/// Limits for `calibrated`: share of signals outside the deciding band, and share of signals too close to the middle.
inline constexpr double least_outside = 0.025, largest_outside = 0.075, least_close = 0.01, largest_close = 0.04;
/// Tolerated deviation of the mean NIS of single Gaussian predictions, as a share of its expected value. It corresponds
/// to a twentieth of the band's width.
inline constexpr double nis_tolerance = 0.1;
/// Limits for `calibrated`: mean NIS per signal, and lag-1 autocorrelation of z.
inline constexpr double least_nis = 0.75, most_nis = 1.3, largest_correlation = 0.2;

/// 1 where a signal is a hit, else 0; run by run, in time order. An element has one byte, because each sample has six
/// elements.
using HitsByRun = std::vector<std::vector<char>>;
SeriesByRun as_numbers(const HitsByRun& hits);

/// Counts over the scored signals of some samples, from which a verdict follows.
struct BandCounts {
  std::array<HitsByRun, coverage_levels.size()> outside;  ///< 1 where a signal lies outside the band, else 0
  HitsByRun far, close;         ///< 1 where z^2 lies above the 97.5 % or below the 2.5 % quantile of chi-square(1)
  SeriesByRun sizes;            ///< sizes of the same signals; a size increases with the distance of the PIT from 1/2
  SquaredDistances nis;         ///< NIS of each sample
  double nis_degrees = 1.0;     ///< n_y
  bool chi_square_nis = false;  ///< whether the NIS is chi-square for a correct model
  double correlation = 0.0;     ///< largest lag-1 autocorrelation of a signal's z by absolute value; 0 if unknown

  /// Starts the next run, with memory for all its samples: growing series would take up to twice the memory.
  void begin_run(const RunEvaluation& run);
  /// Counts sample k of the run.
  void add(const RunEvaluation& run, const RunScores& scores, Eigen::Index k);
};
/// Share of hits; NaN without signals.
double share_of(const HitsByRun& hits);

/// Autocorrelation time of hits, from the sizes of all signals, with a margin. NaN without signals.
double time_by_sizes(const SeriesByRun& sizes);
/// Interval of a fraction of hits, for the effective number of independent samples. `time`: from time_by_sizes.
Interval fraction_interval(const SeriesByRun& hits, double time, double level = 0.95);

/// The verdict for these counts, and why. `time`: from time_by_sizes.
Verdict verdict_of(const BandCounts& counts, double time);

}  // namespace modebank
