#pragma once

#include "filter/judge/statistics.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// Whether a filter's stated uncertainty is true, by its PIT tails: overconfident when more than 4 % of the samples lie
/// above (or fewer than 1 % below) the quantiles that 2.5 % should lie beyond, underconfident the other way round, each
/// with 95 % confidence. Too many above decides, whatever lies below: that is what hurts. Where the tails do not speak,
/// the mean NIS does if every prediction is one Gaussian of known variance (a mixture's NIS is not chi-square, nor that
/// of a filter that learns its noise on the way, so there it is only flagged): when it lies outside the 99 % interval
/// of a true filter's mean and is off by more than a tenth. calibrated: both fractions lie within 1 to 4 %, and neither
/// interval holds all of that band. undecided: all else, as with a few hundred samples.
///
/// Samples that follow each other closely count as fewer: of a tail's hits as few as their autocorrelation time says or
/// that of all samples' sizes (hits are too few to show it in short runs), with a margin for its own error.
enum class Verdict { undecided, calibrated, overconfident, underconfident };

template <>
struct EnumNames<Verdict> {
  static constexpr Names<4> values{"undecided", "calibrated", "overconfident", "underconfident"};
};

/// The band of tail fractions that counts as calibrated.
inline constexpr double least_tail = 0.01, largest_tail = 0.04;

struct Interval {
  double lower, upper;
};

/// Limits of the probability behind `count` successes in `samples` independent trials, Clopper & Pearson (1934), 95 %.
/// Fractions of trials are allowed. NaN without samples.
Interval binomial_interval(double count, double samples);

/// Variance of the terms over that of chi-square terms with the series' mean and `degrees` degrees of freedom each: 1
/// for a true filter whose predictions are single Gaussians, more where rare terms are large, as with modes that are
/// seldom and far. A factor on the terms leaves it. 1 without values or variance.
double dispersion(const SeriesByRun& series, double degrees);

/// Where the mean of a series whose terms have `degrees` degrees of freedom lies with probability `level`: a chi-square
/// law with the degrees of the sum divided by `inflation`, which is the series' autocorrelation time, times its
/// dispersion where the terms are not chi-square (matching of moments: Satterthwaite 1946, Biometrics Bulletin 2).
Interval chi_square_mean_interval(const SeriesByRun& series, double inflation, double degrees, double level = 0.95);

/// What a verdict rests on, over the scored signals of some samples.
struct Evidence {
  SeriesByRun above, below;     ///< 1 where a signal lies in that PIT tail, else 0
  SeriesByRun sizes;            ///< of the same signals: rises with the distance of the PIT from 1/2
  SeriesByRun nis;              ///< per sample
  double nis_degrees = 1.0;     ///< n_y
  bool chi_square_nis = false;  ///< whether a true filter's NIS is chi-square
};

Verdict verdict_of(const Evidence& evidence);

}  // namespace modebank
