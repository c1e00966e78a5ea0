#include "filter/judge/verdict.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/distributions.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

constexpr double beyond_either_end = 0.025;
constexpr double nis_level = 0.99;     // of the interval whose outside is a verdict
constexpr double nis_tolerance = 0.1;  // a tenth of the variance is a twentieth of the interval's width

/// Of a tail's fraction, as many samples as there are independent ones.
Interval tail_interval(const SeriesByRun& hits, double time_by_sizes) {
  const double samples = sample_count(hits) / std::max(autocorrelation_time(hits), time_by_sizes);
  return binomial_interval(mean_of(hits) * samples, samples);
}

bool within_band(double fraction) { return fraction >= least_tail && fraction <= largest_tail; }

/// Whether an interval of a tail's fraction holds all of the band that counts as calibrated, and more: nothing is
/// known.
bool says_nothing(const Interval& tail) { return !(tail.lower >= least_tail || tail.upper <= largest_tail); }

/// What the mean NIS says: -1 underconfident, 1 overconfident, 0 nothing.
int judge_nis(const Evidence& evidence) {
  if (!evidence.chi_square_nis) return 0;
  const double mean = mean_of(evidence.nis), degrees = evidence.nis_degrees;
  const double time = cautious_time(autocorrelation_time(evidence.nis), sample_count(evidence.nis));
  const Interval expected = chi_square_mean_interval(evidence.nis, time, degrees, nis_level);
  if (mean > expected.upper && mean > (1.0 + nis_tolerance) * degrees) return 1;
  if (mean < expected.lower && mean < (1.0 - nis_tolerance) * degrees) return -1;
  return 0;
}

}  // namespace

Interval binomial_interval(double count, double samples) {
  if (!(samples > 0.0)) return {not_a_number, not_a_number};
  const double misses = std::max(0.0, samples - count);
  return {count > 0.0 ? beta_quantile(beyond_either_end, count, misses + 1.0) : 0.0,
          misses > 0.0 ? beta_quantile(1.0 - beyond_either_end, count + 1.0, misses) : 1.0};
}

double dispersion(const SeriesByRun& series, double degrees) {
  const double mean = mean_of(series), count = sample_count(series);
  double squares = 0.0;
  for (const auto& x : series)
    for (const double value : x) squares += (value - mean) * (value - mean);
  return squares > 0.0 ? squares / count * degrees / (2.0 * mean * mean) : 1.0;
}

Interval chi_square_mean_interval(const SeriesByRun& series, double inflation, double degrees, double level) {
  const double count = sample_count(series);
  if (count == 0.0) return {not_a_number, not_a_number};
  const double total = std::max(1.0, count * degrees / inflation), outside = 0.5 * (1.0 - level);
  return {degrees * chi_square_quantile(outside, total) / total,
          degrees * chi_square_quantile(1.0 - outside, total) / total};
}

Verdict verdict_of(const Evidence& evidence) {
  if (sample_count(evidence.above) == 0.0) return Verdict::undecided;
  const double time = cautious_time(autocorrelation_time_of_tail(evidence.sizes), sample_count(evidence.sizes));
  const Interval above = tail_interval(evidence.above, time), below = tail_interval(evidence.below, time);
  if (above.lower > largest_tail) return Verdict::overconfident;
  if (above.upper < least_tail || below.lower > largest_tail) return Verdict::underconfident;
  if (below.upper < least_tail) return Verdict::overconfident;
  if (const int nis = judge_nis(evidence); nis != 0) return nis > 0 ? Verdict::overconfident : Verdict::underconfident;
  const bool inside = within_band(mean_of(evidence.above)) && within_band(mean_of(evidence.below));
  return inside && !says_nothing(above) && !says_nothing(below) ? Verdict::calibrated : Verdict::undecided;
}

}  // namespace modebank
