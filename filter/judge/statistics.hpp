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

/// Statistics of a run's samples, computed once; all judgements use them.
struct RunScores {
  Eigen::MatrixXd z;  ///< n_y x N, Phi^-1(pit): white and standard normal if the model is correct; NaN if missing
  Eigen::VectorXi likeliest;  ///< N, mode most probable before the measurement; 0 for samples without a score
  double whiteness_p = 0.0;   ///< p value of the hypothesis that z has no autocorrelation (whiteness_p)
};
RunScores score_run(const RunEvaluation& evaluation);
/// Phi^-1 of each transform, NaN if the transform is missing.
Eigen::MatrixXd normal_scores(const Eigen::MatrixXd& pit);

/// Residual tests of z over one run; input lag 0 is the input of the predicted transition.
ResidualTests test_innovations(const Trajectory& run, const RunScores& scores, const ResidualTestOptions& options = {});

/// The runs of one row of a table.
struct RunGroup {
  std::string name;               ///< of the run; "*" for all runs of the role
  std::vector<std::size_t> runs;  ///< positions
};
/// Each run of a role, then all of them together; nothing without runs.
std::vector<RunGroup> run_groups(const std::vector<Trajectory>& runs, Role role);

/// Kolmogorov's distance sup |F_n(u) - u| of the sample from the uniform distribution on [0, 1]; NaN without values.
double kolmogorov_distance(std::vector<double> values);
/// Ljung & Box's test of the series with min(20, N/5) lags. NaN if the series is constant or too short for one lag.
double ljung_box_p(const std::vector<double>& series);
/// Fisher's method: combined p value of all tests; -2 sum log p is chi-square with two degrees per test. NaN entries
/// are ignored; NaN if all are.
double fisher_p(const std::vector<double>& p_values);

/// A series per run, in time order.
using SeriesByRun = std::vector<std::vector<double>>;

/// p value of the hypothesis that no output has autocorrelation: Ljung & Box per output, pooled by Fisher's method. NaN
/// if every series is too short. `z`: one series per output.
double whiteness_p(const SeriesByRun& z);

double sample_count(const SeriesByRun& series);
double mean_of(const SeriesByRun& series);  ///< NaN without values

inline constexpr Eigen::Index most_tested_lags = 20;  ///< of the tests of autocorrelation
struct Autocorrelation {
  Eigen::Index lag = 0;
  double value = 0.0;
};
/// The one of largest size at lags 1 to min(most, N / 5), over all series together; lag 0 if these are too short.
Autocorrelation largest_autocorrelation(const SeriesByRun& series, Eigen::Index most = most_tested_lags);

/// Autocorrelation time, at least 1: variance of the mean, divided by its variance for independent terms (initial
/// positive sequence: Geyer 1992, Statistical Science 7). NaN without values.
double autocorrelation_time(const SeriesByRun& series);
/// That of the indicator that a value is among the largest 2.5 %. Such values are too few for a direct estimate, so it
/// follows from the autocorrelations of all values' normal scores, assumed jointly normal.
double autocorrelation_time_of_tail(const SeriesByRun& series);

/// A cautious autocorrelation time from `samples` samples: its excess over 1 is raised by the relative standard error
/// (Madras & Sokal 1988, Journal of Statistical Physics 50) for lags up to twice the time.
double cautious_time(double time, double samples);

struct Interval {
  double lower, upper;
};

/// NIS of single samples, of the available signals. If the model is correct, the NIS of d signals has mean d; it is
/// chi-square with d degrees of freedom if the prediction is one Gaussian of known variance.
struct SquaredDistances {
  SeriesByRun value, degrees;

  /// Sum of distances divided by the sum of degrees, times `of_all`, the degrees of a complete sample: `of_all` if the
  /// model is correct, even with missing signals. NaN without samples.
  double mean(double of_all) const;
  /// Interval that contains the mean of a correct model with probability `level`. The sum is taken for chi-square, its
  /// degrees divided by the (cautious) autocorrelation time of the distances about their share of the mean.
  Interval mean_interval(double of_all, double level) const;
};

/// NIS of every sample on the scale of all signals, N, so that one region applies: if signals are missing, the value
/// for all signals with the same tail probability. NaN if no signal was measured.
Eigen::VectorXd nis_of_all_signals(const RunEvaluation& evaluation);

/// Levels of the central bands whose coverage is counted.
inline constexpr std::array<double, 4> coverage_levels{0.50, 0.90, 0.95, 0.99};
inline constexpr double true_tail = 0.025;  ///< probability of each of the two tails if the model is correct

/// The scored signals of some samples: all counts of coverage and tails refer to them.
struct ScoredSignals {
  SeriesByRun z;         ///< in time order; the signals of a sample stand next to each other
  SquaredDistances nis;  ///< of each sample with a signal

  /// Starts the next run, with memory for all its samples: growing series would take up to twice the memory.
  void begin_run(const RunEvaluation& run);
  void add(const RunEvaluation& run, const RunScores& scores, Eigen::Index k);
};

/// 1 where z lies outside the central band of this level, else 0. z^2 is beyond a quantile of chi-square(1) where z is
/// outside the band of the quantile's probability.
SeriesByRun outside_band(SeriesByRun z, double level);

/// Confidence limits of a probability from `count` (fractional, too) successes in `samples` independent trials (Clopper
/// & Pearson 1934). NaN without samples.
Interval binomial_interval(double count, double samples, double level = 0.95);

}  // namespace modebank
