#pragma once

#include <functional>

namespace modebank {

// Quantiles, tails and densities of the distributions that regions and tests are made from: Boost.Math, compiled once.

/// Phi^-1 of a probability in (0, 1).
double normal_quantile(double probability);
/// z = Phi^-1(pit); pit is clipped to [1e-15, 1 - 1e-15] first, so z is finite.
double normal_score(double pit);

double chi_square_quantile(double probability, double degrees);
double chi_square_density(double value, double degrees);
/// P(X > value), and the value of such a tail.
double chi_square_upper_tail(double value, double degrees);
double chi_square_upper_quantile(double tail, double degrees);

/// Quantile of Fisher's F.
double fisher_quantile(double probability, double numerator, double denominator);
/// Quantile of Student's t; infinitely many degrees: the normal's.
double student_quantile(double probability, double degrees);
/// P(X <= value) of Student's t.
double student_probability(double value, double degrees);
double beta_quantile(double probability, double a, double b);
/// What a binomial count lies below with this probability, and above; rounded outwards to whole numbers.
double binomial_quantile(double probability, double trials, double success);
double binomial_upper_quantile(double probability, double trials, double success);

/// Gauss-Kronrod integral (61 points, adaptive) of a smooth function over [from, to].
double integrate(const std::function<double(double)>& function, double from, double to);

}  // namespace modebank
