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

}  // namespace modebank
