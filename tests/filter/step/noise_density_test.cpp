#include "filter/step/noise_density.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>

namespace modebank {
namespace {

/// The mass in long double: integral of exp(-peak t - t^2 / 2) from the point of largest density on, in pieces in which
/// the logarithm of the integrand decreases by the same amount.
double log_mass_by_quadrature(long double low, long double high) {
  const long double peak = std::clamp(0.0L, low, high);
  const auto integrand = [&](long double t) { return std::exp(-(peak + 0.5L * t) * t); };
  const auto walk = [&](long double until) {
    const long double scale = 0.5L / std::max(1.0L, std::abs(peak)), sign = until < 0.0L ? -1.0L : 1.0L;
    long double sum = 0.0L;
    for (long double t = 0.0L; t < std::abs(until) && t < 140.0L * scale; t += scale) {
      const long double end = std::min(t + scale, std::abs(until));
      sum += boost::math::quadrature::gauss_kronrod<long double, 31>::integrate(integrand, sign > 0.0L ? t : -end,
                                                                                sign > 0.0L ? end : -t, 0);
    }
    return sum;
  };
  const long double sum = walk(high - peak) + walk(low - peak);
  return static_cast<double>(-0.5L * peak * peak - 0.918938533204672741780329736406L + std::log(sum));
}

TEST(IntervalMass, IsThatOfQuadratureHoweverNarrowAndFarOut) {
  for (const double low : {-1e3, -40.0, -8.0, -3.0, -1.0, -0.1, 0.0, 0.5, 2.0, 6.0, 15.0, 29.9, 30.1, 40.0, 1e3})
    for (const double width : {1e-7, 1e-5, 9e-4, 1.1e-3, 0.1, 1.0, 3.0, 10.0, 100.0}) {
      SCOPED_TRACE(testing::Message() << "[" << low << ", " << low << " + " << width << "]");
      const double expected =
          log_mass_by_quadrature(low, static_cast<long double>(low) + static_cast<long double>(width));
      EXPECT_NEAR(log_normal_mass(low + 0.5 * width, width), expected, 1e-11 * std::max(1.0, std::abs(expected)));
      EXPECT_NEAR(log_normal_mass(-low - 0.5 * width, width), expected, 1e-11 * std::max(1.0, std::abs(expected)));
    }
  for (const double width : {1e20, 1e-30}) EXPECT_TRUE(std::isfinite(log_normal_mass(1e50, width)));
}

/// Student's masses of adjacent intervals add up to that of their union.
TEST(IntervalMass, OfStudentsDistributionAddsUp) {
  const StudentNoise noise(5.0);
  for (const double low : {-20.0, -1.0, 0.3, 8.0}) {
    double sum = 0.0;
    for (int i = 0; i < 1000; ++i) sum += std::exp(noise.log_mass(low + (i + 0.5) * 2e-3, 2e-3));
    EXPECT_NEAR(std::log(sum), noise.log_mass(low + 1.0, 2.0), 1e-6) << low;
  }
}

}  // namespace
}  // namespace modebank
