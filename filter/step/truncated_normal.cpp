#include "filter/step/truncated_normal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "ident/base/log_two_pi.hpp"

namespace modebank {
namespace {

double density(double x) { return std::exp(-0.5 * x * x - 0.5 * log_two_pi); }

/// Moments from the error function. `low` must not be far above zero, and the interval must not be narrow.
TruncatedNormal by_differences(double low, double high) {
  const double mass = 0.5 * (std::erfc(low / std::numbers::sqrt2) - std::erfc(high / std::numbers::sqrt2));
  const double at_low = density(low) / mass, at_high = density(high) / mass, mean = at_low - at_high;
  const double variance = 1.0 + (low * at_low - high * at_high) - mean * mean;
  // Moments by integration by parts.
  const double below = low - mean, above = high - mean;
  const double third = below * below * at_low - above * above * at_high - mean * variance;
  const double fourth =
      3.0 * variance + below * below * below * at_low - above * above * above * at_high - mean * third;
  return {std::log(mass), mean, variance, third, fourth};
}

/// Integrals of t^i exp(-low t - t^2 / 2) over [0, width]. The part where the integrand is negligible is left out. In
/// each panel of the quadrature the logarithm of the integrand changes by at most four.
TruncatedNormal by_quadrature(double low, double whole_width) {
  constexpr double negligible = truncated::negligible_exponent;
  const double reach = 2.0 * negligible / (low + std::sqrt(low * low + 2.0 * negligible));
  const double width = std::min(whole_width, reach);
  const double change = (std::abs(low) + 0.5 * width) * width;
  const int panels = 1 + static_cast<int>(change / truncated::most_per_panel);
  const double half = 0.5 * width / panels;
  double sum = 0.0, first = 0.0, second = 0.0, third = 0.0, fourth = 0.0;
  const auto add = [&](double t, double weight) {
    const double value = weight * std::exp(-(low + 0.5 * t) * t);
    const double square = value * t * t;
    sum += value;
    first += value * t;
    second += square;
    third += square * t;
    fourth += square * t * t;
  };
  for (int panel = 0; panel < panels; ++panel)
    for (const auto& [x, weight] : truncated::gauss) {
      const double middle = (2 * panel + 1) * half;
      add(middle - half * x, weight);
      add(middle + half * x, weight);
    }
  const double mean = first / sum, square = second / sum, cube = third / sum;
  return {-0.5 * low * low - 0.5 * log_two_pi + std::log(sum * half), low + mean, square - mean * mean,
          cube - mean * (3.0 * square - 2.0 * mean * mean),
          fourth / sum - mean * (4.0 * cube - mean * (6.0 * square - 3.0 * mean * mean))};
}

/// `width`: high - low. It is an argument because the difference would lose digits.
TruncatedNormal within_interval(double low, double high, double width) {
  low = std::clamp(low, -truncated::furthest, truncated::furthest);
  high = std::clamp(high, -truncated::furthest, truncated::furthest);
  const bool mirrored = low + high < 0.0;
  if (mirrored) low = -std::exchange(high, -low);
  if (!(width > 0.0)) {  // so far from zero that rounding leaves a single point
    const double mean = mirrored ? -low : low;
    return {-0.5 * low * low - 0.5 * log_two_pi + std::log(std::numeric_limits<double>::min()), mean};
  }
  const bool narrow = width < truncated::least_width;
  TruncatedNormal result =
      narrow || low > truncated::largest_start ? by_quadrature(low, width) : by_differences(low, high);
  if (mirrored) {
    result.mean = -result.mean;
    result.third = -result.third;
  }
  result.variance = std::clamp(result.variance, 0.0, 1.0);
  return result;
}

}  // namespace

TruncatedNormal truncated_normal(double low, double high) { return within_interval(low, high, high - low); }

SignalLikelihood signal_likelihood(double e, double s, double quantum) {
  const double deviation = std::sqrt(s), z = e / deviation;
  if (quantum == 0.0) return {-0.5 * log_two_pi - std::log(deviation) - 0.5 * z * z, z};
  const double half = 0.5 * quantum;
  const TruncatedNormal within = within_interval((e - half) / deviation, (e + half) / deviation, quantum / deviation);
  return {within.log_mass - std::log(quantum), within.mean, within.variance, within.third, within.fourth};
}

}  // namespace modebank
