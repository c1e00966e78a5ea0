#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/enum_names.hpp"

namespace modebank {

/// Whether a filter's stated uncertainty is true, by its PIT tails: overconfident when more than 4 % of the samples lie
/// above (or fewer than 1 % below) the quantiles that 2.5 % should lie beyond, underconfident the other way round, each
/// with 95 % confidence. Too many above decides, whatever lies below: that is what hurts. Where the tails do not speak,
/// the mean NIS does if every prediction is one Gaussian of known variance (a mixture's NIS is not chi-square, nor that
/// of a filter that learns its noise on the way, so there it is only flagged): when it lies outside the 99 % interval
/// of a true filter's mean and is off by more than a tenth. undecided: the interval of a tail's fraction is wider than
/// the band and could be anything, as with a few hundred samples.
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

/// Run by run, in the order of time.
using SeriesByRun = std::vector<std::vector<double>>;

/// Autocorrelation time: variance of the mean over that of as many independent terms, at least 1 (initial positive
/// sequence of Geyer 1992, Statistical Science 7). NaN without values.
double autocorrelation_time(const SeriesByRun& series);

/// Mean over all values; NaN without any.
double mean_of(const SeriesByRun& series);

/// Limits of the probability behind `count` successes in `samples` independent trials, Clopper & Pearson (1934), 95 %.
/// Fractions of trials are allowed. NaN without samples.
Interval binomial_interval(double count, double samples);

/// Where the mean of a chi-square series with `degrees` degrees of freedom per term lies with probability `level`;
/// the degrees of the sum are divided by `time`, the series' autocorrelation time.
Interval chi_square_mean_interval(const SeriesByRun& series, double time, double degrees, double level = 0.95);

/// What a verdict rests on, over the scored signals of some samples.
struct Evidence {
  SeriesByRun above, below;     ///< 1 where a signal lies in that PIT tail, else 0
  SeriesByRun nis;              ///< per sample
  double nis_degrees = 1.0;     ///< n_y
  bool chi_square_nis = false;  ///< whether a true filter's NIS is chi-square
};

Verdict judge(const Evidence& evidence);

}  // namespace modebank
