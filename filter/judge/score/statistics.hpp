#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/run/evaluate.hpp"
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

/// Series of z, one vector per output.
using OutputSeries = std::vector<std::vector<double>>;
/// p value of the hypothesis that no output has autocorrelation; NaN if every series is too short.
double whiteness_p(const OutputSeries& z);

/// Kolmogorov's distance sup |F_n(u) - u| of the sample from the uniform distribution on [0, 1]; NaN without values.
double kolmogorov_distance(std::vector<double> values);

/// Ljung & Box's test of the series with min(20, N/5) lags. NaN if the series is constant or too short for one lag.
double ljung_box_p(const std::vector<double>& series);

/// Fisher's method: combined p value of all tests. -2 sum log p is chi-square with two degrees per test. NaN entries
/// are ignored; the result is NaN if all are NaN.
double fisher_p(const std::vector<double>& p_values);

/// A series per run, in time order.
using SeriesByRun = std::vector<std::vector<double>>;

double sample_count(const SeriesByRun& series);
double sum_of(const SeriesByRun& series);

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
/// normal (tetrachoric series: Pearson 1900). NaN without values.
double autocorrelation_time_of_tail(const SeriesByRun& series);

/// A cautious autocorrelation time from `samples` samples. Its excess over 1 is raised by the relative standard error
/// (Madras & Sokal 1988, Journal of Statistical Physics 50). The error assumes lags up to twice the time.
double cautious_time(double time, double samples);

}  // namespace modebank
