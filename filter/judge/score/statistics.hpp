#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/run/evaluate.hpp"
#include "ident/model/residual_tests.hpp"

namespace modebank {

/// What a filter's judges go by beside what it said itself (RunEvaluation's nis, pit and log_density): computed here,
/// once per sample, and handed to all of them.
struct RunScores {
  /// n_y x N, Phi^-1(pit): standard normal and white for a true filter of any kind (innovations of a mixture are not
  /// Gaussian); NaN where nothing was measured.
  Eigen::MatrixXd z;
  /// N, the mode most probable before the measurement; 0 of samples without a score.
  Eigen::VectorXi likeliest;
  /// p value of "no autocorrelation" of the scored samples' z: Ljung & Box per output, pooled by Fisher's method.
  double whiteness_p = 0.0;
};
RunScores score_run(const RunEvaluation& evaluation);
/// Phi^-1 of each transform, NaN where there is none.
Eigen::MatrixXd normal_scores(const Eigen::MatrixXd& pit);
std::vector<RunScores> score_runs(const std::vector<RunEvaluation>& evaluations);

/// Residual tests of a filter's one-step predictions over one run: the residuals are z, and input lag 0 is the input of
/// the predicted transition. Throws std::invalid_argument when sizes disagree.
ResidualTests test_innovations(const Trajectory& run, const RunScores& scores, const ResidualTestOptions& options = {});

/// An output's series of z, one vector per output.
using OutputSeries = std::vector<std::vector<double>>;
/// p value of "no autocorrelation" of all outputs: NaN where no series is long enough.
double whiteness_p(const OutputSeries& z);

/// Kolmogorov's distance sup |F_n(u) - u| of the sample from the uniform distribution on [0, 1]; NaN without values.
double kolmogorov_distance(std::vector<double> values);

/// Ljung & Box's test with min(20, N/5) lags of the series.
/// NaN when the series is too short for one lag or constant.
double ljung_box_p(const std::vector<double>& series);

/// Fisher's method: p value of all tests together, -2 sum log p being chi-square with two degrees per test. NaN entries
/// are left out; NaN when none is left.
double fisher_p(const std::vector<double>& p_values);

/// Run by run, in the order of time.
using SeriesByRun = std::vector<std::vector<double>>;

double sample_count(const SeriesByRun& series);
double sum_of(const SeriesByRun& series);

/// Mean over all values; NaN without any.
double mean_of(const SeriesByRun& series);

/// An autocorrelation and its lag.
struct Autocorrelation {
  Eigen::Index lag = 0;
  double value = 0.0;
};
/// The largest in size of lags 1 to min(20, N / 5) over all series together; 0 at lag 0 where they are too short.
Autocorrelation largest_autocorrelation(const SeriesByRun& series);

/// Autocorrelation time: variance of the mean over that of as many independent terms, at least 1 (initial positive
/// sequence of Geyer 1992, Statistical Science 7). NaN without values.
double autocorrelation_time(const SeriesByRun& series);

/// The same of the series that is 1 where a value is among the largest 2.5 % (or smallest), else 0, without looking at
/// these few: from the autocorrelations of all values' normal scores, as if these were jointly normal (the tetrachoric
/// series of Pearson 1900). NaN without values.
double autocorrelation_time_of_tail(const SeriesByRun& series);

/// An autocorrelation time that `samples` samples showed, what it is above 1 raised by the time's relative standard
/// error (Madras & Sokal 1988, Journal of Statistical Physics 50; as if lags up to twice the time entered).
double cautious_time(double time, double samples);

}  // namespace modebank
