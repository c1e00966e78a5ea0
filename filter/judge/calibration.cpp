#include "filter/judge/calibration.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/distributions.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

constexpr double nis_level = 0.99;  // level of the confidence interval that decides the verdict
constexpr double outside_level = 0.99;
/// Shares of signals outside the band. If significant, they decide a verdict.
constexpr double true_outside = 0.05, many_outside = 0.06, few_outside = 0.025;

/// Verdict of the mean NIS: -1 for underconfident, 1 for overconfident, 0 for neither.
int judge_nis(const BandCounts& counts) {
  if (!counts.chi_square_nis) return 0;
  const double degrees = counts.nis_degrees, mean = mean_distance(counts.nis, degrees);
  const Interval expected = mean_distance_interval(counts.nis, degrees, nis_level);
  if (mean > expected.upper && mean > (1.0 + nis_tolerance) * degrees) return 1;
  if (mean < expected.lower && mean < (1.0 - nis_tolerance) * degrees) return -1;
  return 0;
}

bool within(double value, double least, double largest) { return value >= least && value <= largest; }

/// Whether an interval contains the whole calibrated band and values outside. If so, the data are inconclusive.
bool says_nothing(const Interval& interval, double least, double largest) {
  return interval.lower < least && interval.upper > largest;
}

/// The number that keeps a filter from being calibrated; none if every number passes. `outside`: share of the misses.
CalibrationReason doubt_of(const BandCounts& counts, double outside, const Interval& likely, const Interval& close) {
  if (says_nothing(likely, least_outside, largest_outside) || says_nothing(close, least_close, largest_close))
    return CalibrationReason::few_samples;
  if (!within(outside, least_outside, largest_outside)) return CalibrationReason::band;
  if (!within(share_of(counts.close), least_close, largest_close)) return CalibrationReason::close;
  if (!within(mean_distance(counts.nis, counts.nis_degrees) / counts.nis_degrees, least_nis, most_nis))
    return CalibrationReason::nis;
  return within(counts.correlation, -largest_correlation, largest_correlation) ? CalibrationReason::none
                                                                               : CalibrationReason::pattern;
}

}  // namespace

SeriesByRun as_numbers(const HitsByRun& hits) {
  SeriesByRun numbers;
  for (const std::vector<char>& run : hits) numbers.emplace_back(run.begin(), run.end());
  return numbers;
}

void BandCounts::begin_run(const RunEvaluation& run) {
  const auto samples = static_cast<std::size_t>(run.log_density.size());
  const std::size_t signals = samples * static_cast<std::size_t>(run.pit.rows());
  for (HitsByRun& hits : outside) hits.emplace_back().reserve(signals);
  far.emplace_back().reserve(signals);
  close.emplace_back().reserve(signals);
  sizes.emplace_back().reserve(signals);
  nis.begin_run(samples);
}

void BandCounts::add(const RunEvaluation& run, const RunScores& scores, Eigen::Index k) {
  static const ScoreBands bands;
  for (const double z : scores.z.col(k)) {
    if (std::isnan(z)) continue;
    const ScoreBands::Hits hits = bands.of(z);
    for (std::size_t b = 0; b < outside.size(); ++b) outside[b].back().push_back(hits.outside[b] ? 1 : 0);
    far.back().push_back(hits.far ? 1 : 0);
    close.back().push_back(hits.close ? 1 : 0);
    sizes.back().push_back(std::abs(z));
  }
  nis.add(run.nis(k), scored_signals(run, k));
}

double share_of(const HitsByRun& hits) { return mean_of(as_numbers(hits)); }

double time_by_sizes(const SeriesByRun& sizes) {
  return cautious_time(autocorrelation_time_of_tail(sizes), sample_count(sizes));
}

Interval fraction_interval(const SeriesByRun& hits, double time, double level) {
  const double samples = sample_count(hits) / std::max(autocorrelation_time(hits), time);
  return binomial_interval(mean_of(hits) * samples, samples, level);
}

Verdict verdict_of(const BandCounts& counts, double time) {
  const SeriesByRun misses = as_numbers(counts.outside[deciding_level]);
  if (sample_count(misses) == 0.0) return {};
  const double outside = mean_of(misses);
  const Interval sure = fraction_interval(misses, time, outside_level);
  if (outside > many_outside && sure.lower > true_outside) return {Calibration::overconfident, CalibrationReason::band};
  const Interval close = fraction_interval(as_numbers(counts.close), time);
  if (outside < few_outside && sure.upper < true_outside) return {Calibration::underconfident, CalibrationReason::band};
  if (outside < true_outside && close.lower > largest_close)
    return {Calibration::underconfident, CalibrationReason::close};
  if (const int nis = judge_nis(counts); nis != 0)
    return {nis > 0 ? Calibration::overconfident : Calibration::underconfident, CalibrationReason::nis};
  const CalibrationReason doubt = doubt_of(counts, outside, fraction_interval(misses, time), close);
  return {doubt == CalibrationReason::none ? Calibration::calibrated : Calibration::undecided, doubt};
}

}  // namespace modebank
