#pragma once

#include <cmath>

namespace modebank {

/// Student's t distribution with `degrees` degrees of freedom, scaled to variance one (squared scale (degrees - 2) /
/// degrees). If `degrees` is 0, the normal distribution.
class StudentNoise {
 public:
  /// Throws std::invalid_argument unless `degrees` is 0 or above 2. For 2 or less the variance would be infinite.
  explicit StudentNoise(double degrees);

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
  double probability(double value) const;
  /// log P(|X - middle| <= width / 2), with width > 0.
  double log_mass(double middle, double width) const;

 private:
  double degrees_, log_constant_;
};

}  // namespace modebank
