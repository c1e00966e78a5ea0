#include "filter/step/truncated_normal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>

namespace modebank {
namespace {

/// Moments in long double: integrals of t^i exp(-low t - t^2 / 2). In each piece the logarithm of the integrand
/// decreases by the same amount.
struct Reference {
  long double log_mass, mean, variance, third, fourth;

  Reference(long double low, long double high) {
    const long double peak = std::clamp(0.0L, low, high);  // the integrands are one at this point
    long double sum = 0.0L, first = 0.0L, second = 0.0L, cubes = 0.0L, fourths = 0.0L;
    const auto add = [&](long double from, long double to) {
      const auto moment = [&](int power) {
        const auto integrand = [&](long double t) { return std::pow(t, power) * std::exp(-(peak + 0.5L * t) * t); };
        return boost::math::quadrature::gauss_kronrod<long double, 31>::integrate(integrand, from, to, 0);
      };
      sum += moment(0);
      first += moment(1);
      second += moment(2);
      cubes += moment(3);
      fourths += moment(4);
    };
    const auto walk = [&](long double until) {  // from the peak on, in pieces of half a unit of scale
      const long double scale = 0.5L / std::max(1.0L, std::abs(peak)), sign = until < 0.0L ? -1.0L : 1.0L;
      for (long double t = 0.0L; t < std::abs(until) && t < 140.0L * scale; t += scale) {
        const long double end = std::min(t + scale, std::abs(until));
        add(sign > 0.0L ? t : -end, sign > 0.0L ? end : -t);
      }
    };
    walk(high - peak);
    walk(low - peak);
    mean = peak + first / sum;
    const long double a = first / sum, b = second / sum, c = cubes / sum;
    variance = b - a * a;
    third = c - 3.0L * a * b + 2.0L * a * a * a;
    fourth = fourths / sum - 4.0L * a * c + 6.0L * a * a * b - 3.0L * a * a * a * a;
    log_mass = -0.5L * peak * peak - 0.918938533204672741780329736406L + std::log(sum);
  }
};

void expect_agreement(double low, double width) {
  const double high = low + width;
  if (!(high > low)) return;
  const TruncatedNormal actual = truncated_normal(low, high);
  const Reference expected(low, high);
  SCOPED_TRACE(testing::Message() << "[" << low << ", " << low << " + " << width << "]");
  const double log_mass = static_cast<double>(expected.log_mass);
  EXPECT_NEAR(actual.log_mass, log_mass, 1e-13 * std::max(1.0, std::abs(log_mass)));
  const double deviation = std::sqrt(static_cast<double>(expected.variance));
  EXPECT_NEAR(actual.mean, static_cast<double>(expected.mean), 1e-11 * deviation + 1e-15 * std::abs(low));
  EXPECT_NEAR(actual.variance, static_cast<double>(expected.variance), 2e-11 * static_cast<double>(expected.variance));
  EXPECT_NEAR(actual.third, static_cast<double>(expected.third), 1e-9 * std::pow(deviation, 3));
  EXPECT_NEAR(actual.fourth, static_cast<double>(expected.fourth), 1e-8 * std::pow(deviation, 4));
}

TEST(TruncatedNormal, HasTheMomentsOfQuadratureHoweverNarrowAndFarOut) {
  for (const double low : {-40.0, -8.0, -3.0, -1.0, -0.1, 0.0, 0.5, 2.0, 3.9, 4.1, 6.0, 15.0, 40.0, 1e3, 1e6})
    for (const double width : {1e-7, 1e-4, 0.1, 0.24, 0.26, 1.0, 3.0, 10.0, 100.0}) expect_agreement(low, width);
}

/// The derivatives in the header's comment, compared with differences.
TEST(SignalLikelihood, ItsMomentsAreItsDerivatives) {
  const auto moments = [](const SignalLikelihood& said, double s) {
    return std::array{said.log_density, std::sqrt(s) * said.mean, s * said.variance};
  };
  for (const double s : {1e-3, 2.0})
    for (const double z : {0.0, 0.3, -2.5, 6.0, -30.0, 1e3})
      for (const double share : {0.0, 1e-6, 0.1, 0.3, 3.0, 20.0}) {
        const double root = std::sqrt(s), e = z * root, quantum = share * root;
        SCOPED_TRACE(testing::Message() << "s " << s << ", z " << z << ", quantum " << share << " deviations");
        const SignalLikelihood x = signal_likelihood(e, s, quantum);
        const double excess = (x.variance + x.mean * x.mean - 1.0) / (2.0 * s);
        const std::array by_e{-x.mean / root, 1.0 - x.variance, -root * x.third};
        const std::array by_s{excess, (2.0 * x.mean * x.variance + x.third) / (2.0 * root),
                              0.5 * (2.0 * x.mean * x.third + x.fourth - x.variance * x.variance)};
        const double h = 1e-5 / (1.0 + std::abs(z));
        const auto up_e = moments(signal_likelihood(e + h * root, s, quantum), s);
        const auto down_e = moments(signal_likelihood(e - h * root, s, quantum), s);
        const auto up_s = moments(signal_likelihood(e, s * (1.0 + h), quantum), s * (1.0 + h));
        const auto down_s = moments(signal_likelihood(e, s * (1.0 - h), quantum), s * (1.0 - h));
        const std::array unit{1.0, root, s};  // units of the derivatives

        // The differences contain rounding errors of the bounds.
        const double rounding = share > 0.0 ? 1e-15 * (1.0 + std::abs(z)) / (share * h) : 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
          const double scale = unit[i] * (1.0 + (i == 0 ? z * z : std::abs(z)));
          EXPECT_NEAR((up_e[i] - down_e[i]) / (2.0 * h), by_e[i] * root, 1e-6 * scale + rounding * unit[i]) << i;
          EXPECT_NEAR((up_s[i] - down_s[i]) / (2.0 * h), by_s[i] * s, 1e-6 * scale + rounding * unit[i]) << i;
        }
      }
}

TEST(TruncatedNormal, OfAllNumbersIsNormalAndOfNoneThatCountIsFinite) {
  const TruncatedNormal all = truncated_normal(-1e10, 1e12);
  EXPECT_EQ(all.log_mass, 0.0);
  EXPECT_EQ(all.mean, 0.0);
  EXPECT_EQ(all.variance, 1.0);
  EXPECT_EQ(all.third, 0.0);
  EXPECT_EQ(all.fourth, 3.0);
  const TruncatedNormal none = truncated_normal(1e140, 1e160);
  EXPECT_TRUE(std::isfinite(none.log_mass) && std::isfinite(none.mean) && std::isfinite(none.variance));
}

}  // namespace
}  // namespace modebank
