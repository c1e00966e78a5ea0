#pragma once

#include <functional>

namespace modebank {

// Quantiles, tail probabilities and densities from Boost.Math, for regions and tests. Compiled once.

/// Phi^-1 of a probability in (0, 1).
double normal_quantile(double probability);
/// z = Phi^-1(pit). pit is first clipped to [1e-15, 1 - 1e-15], so that z is finite.
double normal_score(double pit);

double chi_square_quantile(double probability, double degrees);
double chi_square_density(double value, double degrees);
/// The tail probability P(X > value), and the value that has a given tail probability.
double chi_square_upper_tail(double value, double degrees);
double chi_square_upper_quantile(double tail, double degrees);

/// Quantile of Fisher's F.
double fisher_quantile(double probability, double numerator, double denominator);
/// Quantile of Student's t. With infinite degrees of freedom it is the quantile of the normal distribution.
double student_quantile(double probability, double degrees);
/// P(X <= value) for Student's t.
double student_probability(double value, double degrees);
double beta_quantile(double probability, double a, double b);
/// Quantile of a binomial count, rounded outwards to whole numbers.
double binomial_quantile(double probability, double trials, double success);
double binomial_upper_quantile(double probability, double trials, double success);

/// Gauss-Kronrod integral (61 points, adaptive) of a smooth function over [from, to].
double integrate(const std::function<double(double)>& function, double from, double to);

}  // namespace modebank
