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

namespace {

/// Outside a distribution's domain, and if a series does not converge, the result is NaN instead of an exception. Such
/// arguments come from files and from diverged filters; Boost's messages would not help users.
using Quiet = math::policies::policy<math::policies::domain_error<math::policies::ignore_error>,
                                     math::policies::pole_error<math::policies::ignore_error>,
                                     math::policies::overflow_error<math::policies::ignore_error>,
                                     math::policies::evaluation_error<math::policies::ignore_error>>;
using Normal = math::normal_distribution<double, Quiet>;
using ChiSquared = math::chi_squared_distribution<double, Quiet>;
using FisherF = math::fisher_f_distribution<double, Quiet>;
using StudentsT = math::students_t_distribution<double, Quiet>;
using Beta = math::beta_distribution<double, Quiet>;
using Binomial = math::binomial_distribution<double, Quiet>;

}  // namespace

double normal_quantile(double probability) { return math::quantile(Normal(), probability); }

double normal_score(double pit) {
  constexpr double clip = 1e-15;
  return normal_quantile(std::clamp(pit, clip, 1.0 - clip));
}

double chi_square_quantile(double probability, double degrees) {
  return math::quantile(ChiSquared(degrees), probability);
}

double chi_square_density(double value, double degrees) { return math::pdf(ChiSquared(degrees), value); }

double chi_square_upper_tail(double value, double degrees) {
  // this probability is far below the smallest double, and the series does not converge here
  if (value > 1e8 + 1e3 * degrees) return 0.0;
  return math::cdf(math::complement(ChiSquared(degrees), value));
}

double chi_square_upper_quantile(double tail, double degrees) {
  return math::quantile(math::complement(ChiSquared(degrees), tail));
}

double fisher_quantile(double probability, double numerator, double denominator) {
  return math::quantile(FisherF(numerator, denominator), probability);
}

double student_quantile(double probability, double degrees) {
  return std::isinf(degrees) ? normal_quantile(probability) : math::quantile(StudentsT(degrees), probability);
}

double student_probability(double value, double degrees) { return math::cdf(StudentsT(degrees), value); }

double beta_quantile(double probability, double a, double b) { return math::quantile(Beta(a, b), probability); }

double binomial_quantile(double probability, double trials, double success) {
  return math::quantile(Binomial(trials, success), probability);
}

double binomial_upper_quantile(double probability, double trials, double success) {
  return math::quantile(math::complement(Binomial(trials, success), probability));
}

double integrate(const std::function<double(double)>& function, double from, double to) {
  return math::quadrature::gauss_kronrod<double, 61>::integrate(function, from, to);
}

}  // namespace modebank
