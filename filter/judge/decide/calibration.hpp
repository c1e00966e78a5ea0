#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "filter/judge/score/coverage.hpp"
#include "filter/judge/score/squared_distances.hpp"
#include "filter/judge/score/statistics.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// Whether a filter's stated uncertainty is true. overconfident: too many samples lie outside its 95 % band, more than
/// 6 % and with 99 % confidence more than 5 %, however many lie close to its middle. underconfident: fewer than 2.5 %,
/// and with 99 % confidence fewer than 5 %, lie outside; or fewer than 5 % do and with 95 % confidence more than 4 %
/// lie so close to the middle as 2.5 % should (too_close). Where neither speaks, the mean NIS does if every prediction
/// is one Gaussian of known variance (a mixture's NIS is not chi-square, nor that of a filter that learns its noise on
/// the way, so there it is only flagged): when it lies outside the 99 % interval of a true filter's mean and is off by
/// more than a tenth. calibrated: 2.5 to 7.5 % lie outside and 1 to 4 % too close, and neither interval holds all of
/// its band. undecided: all else, as with a few hundred samples.
///
/// Samples that follow each other closely count as fewer: of a band's misses as few as their autocorrelation time says
/// or that of all samples' sizes (hits are too few to show it in short runs), with a margin for its own error.
enum class Calibration { undecided, calibrated, overconfident, underconfident };

template <>
struct EnumNames<Calibration> {
  static constexpr Names<4> values{"undecided", "calibrated", "overconfident", "underconfident"};
};

/// What counts as calibrated: fractions outside the deciding band, and fractions too close to the middle.
inline constexpr double least_outside = 0.025, largest_outside = 0.075, least_close = 0.01, largest_close = 0.04;

/// Shares outside that are a verdict where they are beyond doubt (calibration_of).
inline constexpr double true_outside = 0.05, many_outside = 0.06, few_outside = 0.025;

/// 1 where a signal is a hit, else 0: run by run, in the order of time. In a byte, since there are six of every sample.
using HitsByRun = std::vector<std::vector<char>>;
SeriesByRun as_numbers(const HitsByRun& hits);

/// What a verdict rests on, over the scored signals of some samples.
struct BandCounts {
  std::array<HitsByRun, coverage_levels.size()> outside;  ///< 1 where a signal lies outside that band, else 0
  HitsByRun far, close;         ///< 1 where its z^2 lies above the 97.5 % or below the 2.5 % quantile of chi-square(1)
  SeriesByRun sizes;            ///< of the same signals: rises with the distance of the PIT from 1/2
  SquaredDistances nis;         ///< per sample
  double nis_degrees = 1.0;     ///< n_y
  bool chi_square_nis = false;  ///< whether a true filter's NIS is chi-square
};

/// The autocorrelation time that hits have by the sizes of all signals, with a margin. NaN without signals.
double time_by_sizes(const SeriesByRun& sizes);
/// Of a fraction of hits, with as many samples as there are independent ones. `time`: of time_by_sizes.
Interval fraction_interval(const SeriesByRun& hits, double time, double level = 0.95);

/// Whether an interval holds all of the band that counts as calibrated, and more: nothing is known.
bool says_nothing(const Interval& interval, double least, double largest);

/// `time`: of time_by_sizes.
Calibration calibration_of(const BandCounts& counts, double time);

}  // namespace modebank
