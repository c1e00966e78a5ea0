#include "ident/base/distributions.hpp"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>

namespace modebank {

namespace math = boost::math;

double normal_quantile(double probability) { return math::quantile(math::normal(), probability); }

double normal_score(double pit) {
  constexpr double clip = 1e-15;
  return normal_quantile(std::clamp(pit, clip, 1.0 - clip));
}

double chi_square_quantile(double probability, double degrees) {
  return math::quantile(math::chi_squared(degrees), probability);
}

double chi_square_density(double value, double degrees) { return math::pdf(math::chi_squared(degrees), value); }

double chi_square_upper_tail(double value, double degrees) {
  return math::cdf(math::complement(math::chi_squared(degrees), value));
}

double chi_square_upper_quantile(double tail, double degrees) {
  return math::quantile(math::complement(math::chi_squared(degrees), tail));
}

double fisher_quantile(double probability, double numerator, double denominator) {
  return math::quantile(math::fisher_f(numerator, denominator), probability);
}

double student_quantile(double probability, double degrees) {
  return std::isinf(degrees) ? normal_quantile(probability) : math::quantile(math::students_t(degrees), probability);
}

double student_probability(double value, double degrees) { return math::cdf(math::students_t(degrees), value); }

double beta_quantile(double probability, double a, double b) {
  return math::quantile(math::beta_distribution<>(a, b), probability);
}

double binomial_quantile(double probability, double trials, double success) {
  return math::quantile(math::binomial(trials, success), probability);
}

double binomial_upper_quantile(double probability, double trials, double success) {
  return math::quantile(math::complement(math::binomial(trials, success), probability));
}

double integrate(const std::function<double(double)>& function, double from, double to) {
  return math::quadrature::gauss_kronrod<double, 61>::integrate(function, from, to);
}

}  // namespace modebank
