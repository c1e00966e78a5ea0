#pragma once

#include <array>
#include <utility>

namespace modebank {

/// Moments of a standard normal variable that lies in a known interval.
struct TruncatedNormal {
  double log_mass = 0.0;  ///< log of the interval's probability
  double mean = 0.0;
  double variance = 0.0;             ///< variance, in (0, 1]
  double third = 0.0, fourth = 0.0;  ///< central moments
};

/// Constants shared by the scalar and the vector computation.
namespace truncated {

// Intervals that are narrower or far from zero use quadrature, because differences of the error function lose digits.
inline constexpr double least_width = 0.25;
inline constexpr double largest_start = 4.0;
inline constexpr double furthest = 1e100;
inline constexpr double negligible_exponent = 40.0;  ///< exponents below minus this value are neglected
inline constexpr double most_per_panel = 4.0;        ///< largest change of the integrand's logarithm in one panel

/// Gauss-Legendre quadrature with 12 points: positive abscissas and their weights.
inline constexpr std::array<std::pair<double, double>, 6> gauss{{{0.12523340851146891547, 0.24914704581340278500},
                                                                 {0.36783149899818019375, 0.23349253653835480876},
                                                                 {0.58731795428661744730, 0.20316742672306592175},
                                                                 {0.76990267419430468704, 0.16007832854334622633},
                                                                 {0.90411725637047485668, 0.10693932599531843096},
                                                                 {0.98156063424671925069, 0.04717533638651182720}}};

}  // namespace truncated

/// Moments for [low, high], low <= high, of any width and at any distance from zero. They have about twelve correct
/// digits, `mass` about fourteen. A single point has the smallest representable mass. Bounds beyond 1e100 are set to
/// 1e100.
TruncatedNormal truncated_normal(double low, double high);

/// Likelihood of a Gaussian signal that is recorded in multiples of a quantum. Also its moments given the recorded
/// value.
struct SignalLikelihood {
  /// Log of the interval's mean density, log(mass / q). As q goes to 0, it tends to the log density. So scores of
  /// coarse and fine data have the same unit. For the same data, differences between models equal differences of log
  /// mass.
  double log_density = 0.0;
  /// Mean m, variance v, third and fourth central moments of the standardised innovation given the measurement. u is
  /// sqrt(s) times this innovation and has mean M and variance V. The four moments also give these derivatives
  /// (cumulants of an exponential family):
  ///   d log_density / de = -m / sqrt(s)    d log_density / ds = (v + m^2 - 1) / 2s
  ///   dM/de = 1 - v                        dM/ds = (2 m v + third) / 2 sqrt(s)
  ///   dV/de = -sqrt(s) third               dV/ds = (2 m third + fourth - v^2) / 2
  double mean = 0.0, variance = 0.0, third = 0.0, fourth = 0.0;
};

/// `e`: innovation of variance `s` > 0. A signal of quantum zero has exactly the recorded value.
SignalLikelihood signal_likelihood(double e, double s, double quantum);

}  // namespace modebank
