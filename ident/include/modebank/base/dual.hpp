#pragma once

#include <array>
#include <cmath>
#include <compare>
#include <cstddef>

namespace modebank {

/// A number with its derivatives with respect to D variables. Arithmetic on such numbers is forward automatic
/// differentiation (Griewank & Walther 2008, "Evaluating Derivatives", chapter 3). A double converts to a constant.
template <int D>
struct Dual {
  double value = 0.0;             ///< value of the number
  std::array<double, D> slope{};  ///< derivatives with respect to the variables

  /// Zero, a constant.
  Dual() = default;
  /// A constant.
  Dual(double constant) : value(constant) {}
  /// Variable number `variable` (from 0) with value `at`.
  Dual(double at, int variable) : value(at) { slope[static_cast<std::size_t>(variable)] = 1.0; }

  /// f(a), from its value and its derivative with respect to a.
  static Dual of(double f, double by_a, const Dual& a) {
    Dual result(f);
    for (std::size_t i = 0; i < D; ++i) result.slope[i] = by_a * a.slope[i];
    return result;
  }
  /// f(a, b), from its value and its derivatives with respect to a and b.
  static Dual of(double f, double by_a, const Dual& a, double by_b, const Dual& b) {
    Dual result(f);
    for (std::size_t i = 0; i < D; ++i) result.slope[i] = by_a * a.slope[i] + by_b * b.slope[i];
    return result;
  }

  /// -a.
  friend Dual operator-(const Dual& a) { return of(-a.value, -1.0, a); }
  /// a + b.
  friend Dual operator+(const Dual& a, const Dual& b) { return of(a.value + b.value, 1.0, a, 1.0, b); }
  /// a - b.
  friend Dual operator-(const Dual& a, const Dual& b) { return of(a.value - b.value, 1.0, a, -1.0, b); }
  /// a b.
  friend Dual operator*(const Dual& a, const Dual& b) { return of(a.value * b.value, b.value, a, a.value, b); }
  /// a / b.
  friend Dual operator/(const Dual& a, const Dual& b) {
    const double ratio = a.value / b.value;
    return of(ratio, 1.0 / b.value, a, -ratio / b.value, b);
  }
  /// Adds b.
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  /// Subtracts b.
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  /// Multiplies by b.
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  /// Divides by b.
  Dual& operator/=(const Dual& b) { return *this = *this / b; }
  /// Compares values.
  friend bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  /// Compares values.
  friend std::partial_ordering operator<=>(const Dual& a, const Dual& b) { return a.value <=> b.value; }

  /// e to the power a.
  friend Dual exp(const Dual& a) {
    const double f = std::exp(a.value);
    return of(f, f, a);
  }
  /// Natural logarithm.
  friend Dual log(const Dual& a) { return of(std::log(a.value), 1.0 / a.value, a); }
  /// Square root.
  friend Dual sqrt(const Dual& a) {
    const double f = std::sqrt(a.value);
    return of(f, 0.5 / f, a);
  }
  /// Absolute value; its derivative at zero is 1.
  friend Dual abs(const Dual& a) { return of(std::abs(a.value), a.value < 0.0 ? -1.0 : 1.0, a); }
  /// Sine of a [rad].
  friend Dual sin(const Dual& a) { return of(std::sin(a.value), std::cos(a.value), a); }
  /// Cosine of a [rad].
  friend Dual cos(const Dual& a) { return of(std::cos(a.value), -std::sin(a.value), a); }
  /// Tangent of a [rad].
  friend Dual tan(const Dual& a) {
    const double f = std::tan(a.value);
    return of(f, 1.0 + f * f, a);
  }
  /// Hyperbolic tangent.
  friend Dual tanh(const Dual& a) {
    const double f = std::tanh(a.value);
    return of(f, 1.0 - f * f, a);
  }
  /// Arc tangent [rad].
  friend Dual atan(const Dual& a) { return of(std::atan(a.value), 1.0 / (1.0 + a.value * a.value), a); }
  /// Angle of the point (x, y) [rad].
  friend Dual atan2(const Dual& y, const Dual& x) {
    const double square = x.value * x.value + y.value * y.value;
    return of(std::atan2(y.value, x.value), x.value / square, y, -y.value / square, x);
  }
  /// Square root of a^2 + b^2.
  friend Dual hypot(const Dual& a, const Dual& b) {
    const double f = std::hypot(a.value, b.value);
    return of(f, a.value / f, a, b.value / f, b);
  }
  /// a to the power b. The derivative with respect to b is set to zero unless a is positive.
  friend Dual pow(const Dual& a, const Dual& b) {
    const double f = std::pow(a.value, b.value);
    const double by_b = a.value > 0.0 ? f * std::log(a.value) : 0.0;  // otherwise b is a whole constant exponent
    return of(f, b.value * std::pow(a.value, b.value - 1.0), a, by_b, b);
  }
};

}  // namespace modebank
