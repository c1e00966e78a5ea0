#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "filter/step/gaussian.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/log_two_pi.hpp"

namespace modebank {

/// Phi(x). The relative error is small far into the lower tail.
inline double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// log(Phi(middle + width / 2) - Phi(middle - width / 2)), width > 0. It has about twelve digits for any arguments: the
/// interval is mirrored to the lower tail, where differences keep their digits; a narrow interval has the density at
/// its middle, with the second derivative; beyond the range of erfc Mills' ratio is an asymptotic series.
inline double log_normal_mass(double middle, double width) {
  constexpr double narrow = 1e-3, far = -30.0;
  const double m = std::abs(middle), low = -m - 0.5 * width, high = 0.5 * width - m;
  if (width * (1.0 + m) < narrow)
    return std::log(width) - 0.5 * (log_two_pi + m * m) + (m * m - 1.0) * width * width / 24.0;
  if (high > far) return std::log(normal_cdf(high) - normal_cdf(low));
  const auto ratio = [](double x) {  // Phi(x) / phi(x)
    const double s = 1.0 / (x * x);
    return (1.0 - s * (1.0 - 3.0 * s * (1.0 - 5.0 * s * (1.0 - 7.0 * s)))) / -x;
  };
  return std::log(ratio(high) - ratio(low) * std::exp(-m * width)) - 0.5 * (log_two_pi + high * high);
}

/// Student's t distribution, scaled to variance one. With 0 degrees of freedom, the normal distribution.
class StudentNoise {
 public:
  /// Throws std::invalid_argument unless `degrees` is 0 or above 2: the variance would be infinite.
  explicit StudentNoise(double degrees) : degrees_(degrees), log_constant_(-0.5 * log_two_pi) {
    if (degrees != 0.0 && !(degrees > 2.0 && std::isfinite(degrees)))
      throw std::invalid_argument(
          "degrees of freedom of Student's t must be above 2, or 0 for the normal distribution: " +
          std::to_string(degrees));
    if (!gaussian())
      log_constant_ = std::lgamma(0.5 * (degrees + 1.0)) - std::lgamma(0.5 * degrees) -
                      0.5 * std::log(std::numbers::pi * (degrees - 2.0));
  }

  double degrees() const { return degrees_; }
  bool gaussian() const { return degrees_ == 0.0; }
  double log_constant() const { return log_constant_; }  ///< of the log density: does not depend on the value [nats]
  /// Log density [nats] of a value, given the value's square.
  double log_density(double square) const {
    return gaussian() ? log_constant_ - 0.5 * square
                      : log_constant_ - 0.5 * (degrees_ + 1.0) * std::log1p(square / (degrees_ - 2.0));
  }
  /// P(X <= value).
  double probability(double value) const {
    if (gaussian()) return normal_cdf(value);
    return student_probability(value * std::sqrt(degrees_ / (degrees_ - 2.0)), degrees_);
  }
  /// The value with P(X <= value) = `probability`.
  double quantile(double probability) const {
    return gaussian() ? normal_quantile(probability)
                      : student_quantile(probability, degrees_) * std::sqrt((degrees_ - 2.0) / degrees_);
  }
  /// log P(|X - middle| <= width / 2), with width > 0.
  double log_mass(double middle, double width) const {
    if (gaussian()) return log_normal_mass(middle, width);
    // The difference over an interval that is narrow compared with its distance from zero loses digits.
    constexpr double narrow = 1e-3;
    if (width < narrow * (1.0 + std::abs(middle))) return log_density(middle * middle) + std::log(width);
    const double high = 0.5 * width - std::abs(middle);  // the lower tail has more accurate digits
    return std::log(probability(high) - probability(high - width));
  }

 private:
  double degrees_, log_constant_;
};

/// The distribution of one signal: a mixture.
struct SignalMixture {
  Eigen::VectorXd weight, mean, deviation;
  StudentNoise noise = StudentNoise(0.0);

  double centre() const { return weight.dot(mean); }
  double standard_deviation() const {
    return std::sqrt((weight.array() * (deviation.array().square() + (mean.array() - centre()).square())).sum());
  }
  /// P(X <= y); 1 if the prediction failed.
  double probability(double y) const {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < weight.size(); ++j) sum += weight(j) * noise.probability((y - mean(j)) / deviation(j));
    return sum < 1.0 ? sum : 1.0;
  }
  /// By bisection between the parts' own quantiles.
  double quantile(double probability_below) const {
    constexpr double negligible_weight = 1e-9;  // smallest weight of a part that can matter at the edge of a band
    const double score = noise.quantile(probability_below);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (Eigen::Index j = 0; j < weight.size(); ++j) {
      if (!(weight(j) > negligible_weight)) continue;
      low = std::min(low, mean(j) + score * deviation(j));
      high = std::max(high, mean(j) + score * deviation(j));
    }
    constexpr int most_halvings = 200;
    constexpr double close = 1e-12;
    for (int i = 0; i < most_halvings && high - low > close * (std::abs(low) + std::abs(high)); ++i) {
      const double middle = 0.5 * (low + high);
      (probability(middle) < probability_below ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
};

/// One signal's innovation in one mode, given the previous signals, and its variance.
struct ModeSignal {
  double e = 0.0, s = 0.0;

  /// Standard deviation before rounding. s contains its variance, q^2 / 12, which the mass must not count again.
  double unrounded_deviation(double quantum) const {
    return std::sqrt(std::max(s - quantum * quantum / 12.0, relative_pivot_floor * s));
  }
  /// Log of the mean density of the reading's interval, log(mass / q); for q = 0 the log density, in the same unit.
  double log_density(double quantum) const {
    if (quantum == 0.0) return -0.5 * (log_two_pi + std::log(s) + e * e / s);
    const double deviation = unrounded_deviation(quantum);
    return measured_density(log_normal_mass(e / deviation, quantum / deviation) - std::log(quantum));
  }
};

}  // namespace modebank
