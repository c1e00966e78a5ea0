#include "filter/step/noise_density.hpp"

#include <stdexcept>
#include <string>

#include "ident/base/distributions.hpp"

namespace modebank {

namespace {

constexpr double pi = std::numbers::pi;

double student_log_constant(double degrees) {
  if (degrees == 0.0) return -0.5 * log_two_pi;
  return std::lgamma(0.5 * (degrees + 1.0)) - std::lgamma(0.5 * degrees) - 0.5 * std::log(pi * (degrees - 2.0));
}

}  // namespace

StudentNoise::StudentNoise(double degrees) : degrees_(degrees), log_constant_(0.0) {
  if (degrees != 0.0 && !(degrees > 2.0 && std::isfinite(degrees)))
    throw std::invalid_argument(
        "degrees of freedom of Student's t must be above 2, or 0 for the normal distribution: " +
        std::to_string(degrees));
  log_constant_ = student_log_constant(degrees);
}

double StudentNoise::probability(double value) const {
  if (gaussian()) return normal_cdf(value);
  return student_probability(value * std::sqrt(degrees_ / (degrees_ - 2.0)), degrees_);
}

double StudentNoise::log_mass(double middle, double width) const {
  if (gaussian()) return log_normal_mass(middle, width);
  // If an interval is narrow compared with its distance from zero, the difference loses digits. The probability is then
  // computed from the density.
  constexpr double narrow = 1e-3;
  if (width < narrow * (1.0 + std::abs(middle))) return log_density(middle * middle) + std::log(width);
  const double high = 0.5 * width - std::abs(middle);  // the lower tail has more accurate digits
  return std::log(probability(high) - probability(high - width));
}

}  // namespace modebank
