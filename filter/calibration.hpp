#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// Quantile of the chi-square distribution.
double chi_square_quantile(double probability, double degrees_of_freedom);

/// z = Phi^-1(pit); pit is clipped to [1e-15, 1 - 1e-15] first, so z is finite.
double normal_score(double pit);

/// Kolmogorov's distance sup |F_n(u) - u| of the sample from the uniform distribution on [0, 1]; NaN without values.
double kolmogorov_distance(std::vector<double> values);

/// Portmanteau test of Ljung & Box (1978), Biometrika 65(2), with min(20, N/5) lags: p value of "no autocorrelation".
/// NaN when the series is too short for one lag or constant.
double ljung_box_p(const std::vector<double>& series);

/// Fisher's method: p value of all tests together, -2 sum log p being chi-square with two degrees per test. NaN entries
/// are left out; NaN when none is left.
double fisher_p(const std::vector<double>& p_values);

/// How many of the values fall into each of `bins` equal parts of [0, 1]; the last one holds 1. Values that are not
/// finite or lie outside are not counted. Throws std::invalid_argument for bins < 1.
std::vector<Eigen::Index> uniform_counts(const std::vector<double>& values, Eigen::Index bins);

/// Between which counts a bin of `bins` equal ones lies with probability `level` when `samples` independent values are
/// uniform: the binomial's quantiles, (1 - level) / 2 outside on either side at most.
struct CountInterval {
  double lower, upper;
};
CountInterval uniform_count_interval(Eigen::Index samples, Eigen::Index bins, double level);

}  // namespace modebank
