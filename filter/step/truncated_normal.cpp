#include "filter/step/truncated_normal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace modebank {
namespace {

constexpr double log_root_two_pi = 0.91893853320467274178;
constexpr double furthest = 1e100;

// Differences of the error function lose digits where the interval is narrow or far out: quadrature takes over.
constexpr double least_width = 0.25;
constexpr double largest_start = 4.0;

/// Gauss-Legendre, 12 points: abscissas above zero and their weights.
constexpr std::array<std::pair<double, double>, 6> gauss{{{0.12523340851146891547, 0.24914704581340278500},
                                                          {0.36783149899818019375, 0.23349253653835480876},
                                                          {0.58731795428661744730, 0.20316742672306592175},
                                                          {0.76990267419430468704, 0.16007832854334622633},
                                                          {0.90411725637047485668, 0.10693932599531843096},
                                                          {0.98156063424671925069, 0.04717533638651182720}}};

double density(double x) { return std::exp(-0.5 * x * x - log_root_two_pi); }

/// By the error function; `low` not far above zero, the interval not narrow.
TruncatedNormal by_differences(double low, double high) {
  const double mass = 0.5 * (std::erfc(low / std::numbers::sqrt2) - std::erfc(high / std::numbers::sqrt2));
  const double at_low = density(low), at_high = density(high), mean = (at_low - at_high) / mass;
  return {std::log(mass), mean, 1.0 + (low * at_low - high * at_high) / mass - mean * mean};
}

/// Integrals of t^i exp(-low t - t^2 / 2) over [0, width], as far as the integrand counts, in panels over each of which
/// its logarithm changes by no more than four.
TruncatedNormal by_quadrature(double low, double high) {
  constexpr double negligible = 40.0, most_per_panel = 4.0;
  const double reach = 2.0 * negligible / (low + std::sqrt(low * low + 2.0 * negligible));
  const double width = std::min(high - low, reach);
  const double change = (std::abs(low) + 0.5 * width) * width;
  const int panels = 1 + static_cast<int>(change / most_per_panel);
  const double half = 0.5 * width / panels;
  double sum = 0.0, first = 0.0, second = 0.0;
  const auto add = [&](double t, double weight) {
    const double value = weight * std::exp(-(low + 0.5 * t) * t);
    sum += value;
    first += value * t;
    second += value * t * t;
  };
  for (int panel = 0; panel < panels; ++panel)
    for (const auto& [x, weight] : gauss) {
      const double middle = (2 * panel + 1) * half;
      add(middle - half * x, weight);
      add(middle + half * x, weight);
    }
  const double mean = first / sum;
  return {-0.5 * low * low - log_root_two_pi + std::log(sum * half), low + mean, second / sum - mean * mean};
}

}  // namespace

TruncatedNormal truncated_normal(double low, double high) {
  low = std::clamp(low, -furthest, furthest);
  high = std::clamp(high, -furthest, furthest);
  const bool mirrored = low + high < 0.0;
  if (mirrored) low = -std::exchange(high, -low);
  if (!(high > low)) {  // so far out that rounding leaves a point
    const double mean = mirrored ? -low : low;
    return {-0.5 * low * low - log_root_two_pi + std::log(std::numeric_limits<double>::min()), mean, 0.0};
  }
  const bool narrow = high - low < least_width;
  TruncatedNormal result = narrow || low > largest_start ? by_quadrature(low, high) : by_differences(low, high);
  if (mirrored) result.mean = -result.mean;
  result.variance = std::clamp(result.variance, 0.0, 1.0);
  return result;
}

}  // namespace modebank
