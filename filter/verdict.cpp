#include "filter/verdict.hpp"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <cmath>

#include "filter/calibration.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

namespace {

constexpr double beyond_either_end = 0.025;
constexpr double nis_level = 0.99;     // of the interval whose outside is a verdict
constexpr double nis_tolerance = 0.1;  // a tenth of the variance is a twentieth of the interval's width

double count_of(const SeriesByRun& series) {
  double count = 0.0;
  for (const auto& x : series) count += static_cast<double>(x.size());
  return count;
}

/// Of a tail's fraction, as many samples as there are independent ones.
Interval tail_interval(const SeriesByRun& hits) {
  const double time = autocorrelation_time(hits), samples = count_of(hits) / time;
  return binomial_interval(mean_of(hits) * samples, samples);
}

/// Whether an interval of a tail's fraction holds all of the band that counts as calibrated, and more: nothing is
/// known.
bool says_nothing(const Interval& tail) { return !(tail.lower >= least_tail || tail.upper <= largest_tail); }

/// What the mean NIS says: -1 underconfident, 1 overconfident, 0 nothing.
int judge_nis(const Evidence& evidence) {
  if (!evidence.chi_square_nis) return 0;
  const double mean = mean_of(evidence.nis), degrees = evidence.nis_degrees;
  const Interval expected =
      chi_square_mean_interval(evidence.nis, autocorrelation_time(evidence.nis), degrees, nis_level);
  if (mean > expected.upper && mean > (1.0 + nis_tolerance) * degrees) return 1;
  if (mean < expected.lower && mean < (1.0 - nis_tolerance) * degrees) return -1;
  return 0;
}

}  // namespace

double mean_of(const SeriesByRun& series) {
  double sum = 0.0;
  for (const auto& x : series)
    for (const double value : x) sum += value;
  const double count = count_of(series);
  return count > 0.0 ? sum / count : not_a_number;
}

double autocorrelation_time(const SeriesByRun& series) {
  const double mean = mean_of(series);
  if (std::isnan(mean)) return not_a_number;
  std::size_t longest = 0;
  for (const auto& x : series) longest = std::max(longest, x.size());
  const auto autocovariance = [&](std::size_t lag) {
    double sum = 0.0;
    for (const auto& x : series)
      for (std::size_t k = lag; k < x.size(); ++k) sum += (x[k] - mean) * (x[k - lag] - mean);
    return sum;
  };
  const double variance = autocovariance(0);
  if (!(variance > 0.0)) return 1.0;
  double time = -1.0;
  for (std::size_t lag = 0; lag + 1 < longest; lag += 2) {
    const double pair = (lag == 0 ? variance : autocovariance(lag)) + autocovariance(lag + 1);
    if (pair <= 0.0) break;
    time += 2.0 * pair / variance;
  }
  return std::max(1.0, time);
}

Interval binomial_interval(double count, double samples) {
  if (!(samples > 0.0)) return {not_a_number, not_a_number};
  using Beta = boost::math::beta_distribution<>;
  const double misses = std::max(0.0, samples - count);
  return {count > 0.0 ? boost::math::quantile(Beta(count, misses + 1.0), beyond_either_end) : 0.0,
          misses > 0.0 ? boost::math::quantile(Beta(count + 1.0, misses), 1.0 - beyond_either_end) : 1.0};
}

Interval chi_square_mean_interval(const SeriesByRun& series, double time, double degrees, double level) {
  const double count = count_of(series);
  if (count == 0.0) return {not_a_number, not_a_number};
  const double total = std::max(1.0, count * degrees / time), outside = 0.5 * (1.0 - level);
  return {degrees * chi_square_quantile(outside, total) / total,
          degrees * chi_square_quantile(1.0 - outside, total) / total};
}

Verdict judge(const Evidence& evidence) {
  if (count_of(evidence.above) == 0.0) return Verdict::undecided;
  const Interval above = tail_interval(evidence.above), below = tail_interval(evidence.below);
  if (above.lower > largest_tail) return Verdict::overconfident;
  if (above.upper < least_tail || below.lower > largest_tail) return Verdict::underconfident;
  if (below.upper < least_tail) return Verdict::overconfident;
  if (const int nis = judge_nis(evidence); nis != 0) return nis > 0 ? Verdict::overconfident : Verdict::underconfident;
  return says_nothing(above) || says_nothing(below) ? Verdict::undecided : Verdict::calibrated;
}

}  // namespace modebank
