#pragma once

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

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

/// Student's t distribution with `degrees` degrees of freedom, scaled to variance one (squared scale (degrees - 2) /
/// degrees). If `degrees` is 0, the normal distribution.
class StudentNoise {
 public:
  /// Throws std::invalid_argument unless `degrees` is 0 or above 2. For 2 or less the variance would be infinite.
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
  /// The part of the log density that does not depend on the value [nats].
  double log_constant() const { return log_constant_; }
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
  /// log P(|X - middle| <= width / 2), with width > 0.
  double log_mass(double middle, double width) const {
    if (gaussian()) return log_normal_mass(middle, width);
    // If an interval is narrow compared with its distance from zero, the difference loses digits. The probability is
    // then computed from the density.
    constexpr double narrow = 1e-3;
    if (width < narrow * (1.0 + std::abs(middle))) return log_density(middle * middle) + std::log(width);
    const double high = 0.5 * width - std::abs(middle);  // the lower tail has more accurate digits
    return std::log(probability(high) - probability(high - width));
  }

 private:
  double degrees_, log_constant_;
};

}  // namespace modebank
