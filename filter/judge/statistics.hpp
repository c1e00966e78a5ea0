#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/residual_tests.hpp"

namespace modebank {

/// Statistics of a run derived from RunEvaluation's nis, pit and log_density. They are computed here once per sample,
/// and all judgements use them.
struct RunScores {
  /// n_y x N, Phi^-1(pit): standard normal and white if the model is correct (innovations of a mixture are not
  /// Gaussian). NaN if the signal was not measured.
  Eigen::MatrixXd z;
  /// N, mode most probable before the measurement; 0 for samples without a score.
  Eigen::VectorXi likeliest;
  /// p value of the hypothesis that z has no autocorrelation in the scored samples: Ljung & Box per output, pooled by
  /// Fisher's method.
  double whiteness_p = 0.0;
};
RunScores score_run(const RunEvaluation& evaluation);
/// Phi^-1 of each transform, NaN if the transform is missing.
Eigen::MatrixXd normal_scores(const Eigen::MatrixXd& pit);
std::vector<RunScores> score_runs(const std::vector<RunEvaluation>& evaluations);

/// Residual tests of a filter's one-step predictions over one run. The residuals are z; input lag 0 is the input of the
/// predicted transition. Throws std::invalid_argument if sizes disagree.
ResidualTests test_innovations(const Trajectory& run, const RunScores& scores, const ResidualTestOptions& options = {});

/// Sums the runs of a role: calls row(sums, name) for each run in order, then for all of them together, with the name
/// "*". `add`: adds the i-th run to some sums, which are Sums() at first.
template <class Sums, class Add, class Row>
void sum_runs(const std::vector<Trajectory>& runs, Role role, Add add, Row row) {
  Sums all;
  bool any = false;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].role != role) continue;
    Sums one;
    add(i, one);
    row(one, runs[i].run);
    add(i, all);
    any = true;
  }
  if (any) row(all, "*");
}

/// Kolmogorov's distance sup |F_n(u) - u| of the sample from the uniform distribution on [0, 1]; NaN without values.
double kolmogorov_distance(std::vector<double> values);

/// Ljung & Box's test of the series with min(20, N/5) lags. NaN if the series is constant or too short for one lag.
double ljung_box_p(const std::vector<double>& series);

/// Fisher's method: combined p value of all tests. -2 sum log p is chi-square with two degrees per test. NaN entries
/// are ignored; the result is NaN if all are NaN.
double fisher_p(const std::vector<double>& p_values);

/// A series per run, in time order.
using SeriesByRun = std::vector<std::vector<double>>;

/// p value of the hypothesis that no output has autocorrelation; NaN if every series is too short. `z`: one series per
/// output.
double whiteness_p(const SeriesByRun& z);

double sample_count(const SeriesByRun& series);
/// Mean over all values; NaN without values.
double mean_of(const SeriesByRun& series);

/// Largest lag of the tests of autocorrelation.
inline constexpr Eigen::Index most_tested_lags = 20;

/// An autocorrelation and its lag.
struct Autocorrelation {
  Eigen::Index lag = 0;
  double value = 0.0;
};
/// The autocorrelation of largest absolute value at lags 1 to min(most, N / 5), over all series together. The result
/// has lag 0 if the series are too short.
Autocorrelation largest_autocorrelation(const SeriesByRun& series, Eigen::Index most = most_tested_lags);

/// Autocorrelation time, at least 1: variance of the mean, divided by its variance for independent terms (initial
/// positive sequence: Geyer 1992, Statistical Science 7). NaN without values.
double autocorrelation_time(const SeriesByRun& series);

/// Autocorrelation time of the indicator that a value is among the largest (or smallest) 2.5 %. Such values are too few
/// for a direct estimate. So the time follows from the autocorrelations of all values' normal scores, assumed jointly
/// normal. NaN without values.
double autocorrelation_time_of_tail(const SeriesByRun& series);

/// A cautious autocorrelation time from `samples` samples. Its excess over 1 is raised by the relative standard error
/// (Madras & Sokal 1988, Journal of Statistical Physics 50). The error assumes lags up to twice the time.
double cautious_time(double time, double samples);

struct Interval {
  double lower, upper;
};

/// Squared distances of single samples relative to the filter's covariance: NIS of the available signals, or NEES of
/// the judged states. If the model is correct, a distance of d signals has mean d. It is chi-square with d degrees of
/// freedom if the prediction is one Gaussian of known variance.
struct SquaredDistances {
  SeriesByRun value;
  SeriesByRun degrees;  ///< degrees of freedom of each distance

  /// `samples`: memory to reserve.
  void begin_run(std::size_t samples = 0);
  /// `d`: degrees of freedom. If `d` is 0, nothing is added.
  void add(double distance, Eigen::Index d);
};

/// Number of scored signals of a sample.
Eigen::Index scored_signals(const RunEvaluation& evaluation, Eigen::Index sample);

/// Sum of distances divided by the sum of degrees, times `of_all`, the degrees of a complete sample. If the model is
/// correct, the mean is therefore `of_all`, even with missing signals. A sample's weight is its degrees. NaN without
/// samples.
double mean_distance(const SquaredDistances& distances, double of_all);

/// Interval that contains mean_distance of a correct model with probability `level`. The sum is treated as chi-square.
/// Its degrees are divided by the autocorrelation time of the distances about their share of the mean, with a margin
/// (cautious_time). Single distances must be chi-square. NaN without samples.
Interval mean_distance_interval(const SquaredDistances& distances, double of_all, double level);

/// NIS of every sample on the scale of all signals, N. So one region applies to all samples. If signals are missing,
/// the NIS is converted to the value for all signals with the same tail probability. NaN if no signal was measured.
Eigen::VectorXd nis_of_all_signals(const RunEvaluation& evaluation);

/// Levels of the central bands whose coverage is counted, and the level that decides.
inline constexpr std::array<double, 4> coverage_levels{0.50, 0.90, 0.95, 0.99};
inline constexpr std::size_t deciding_level = 2;

/// Probability of each of the two tails if the model is correct.
inline constexpr double true_tail = 0.025;

/// Bands and tails of a normal score z. All counts of coverage and tails use them.
struct BandHits {
  std::array<bool, coverage_levels.size()> outside;  ///< whether |z| lies outside each central band
  bool far, close;  ///< whether z^2 is above the upper, or below the lower true_tail quantile of chi-square(1)
};
BandHits band_hits(double z);

/// Confidence limits of a probability from `count` successes in `samples` independent trials (Clopper & Pearson 1934).
/// Fractional counts are allowed. NaN without samples.
Interval binomial_interval(double count, double samples, double level = 0.95);

}  // namespace modebank
