#pragma once

#include <array>
#include <utility>

namespace modebank {

/// A standard normal variable that is known to lie in an interval.
struct TruncatedNormal {
  double log_mass = 0.0;  ///< log of the interval's probability
  double mean = 0.0;
  double variance = 0.0;             ///< in (0, 1]
  double third = 0.0, fourth = 0.0;  ///< moments about the mean
};

/// What the scalar and the vector computation have in common.
namespace truncated {

// Differences of the error function lose digits where the interval is narrow or far out: quadrature takes over.
inline constexpr double least_width = 0.25;
inline constexpr double largest_start = 4.0;
inline constexpr double furthest = 1e100;
inline constexpr double negligible_exponent = 40.0;  ///< exp of minus this is not looked for
inline constexpr double most_per_panel = 4.0;        ///< change of the integrand's logarithm

/// Gauss-Legendre, 12 points: abscissas above zero and their weights.
inline constexpr std::array<std::pair<double, double>, 6> gauss{{{0.12523340851146891547, 0.24914704581340278500},
                                                                 {0.36783149899818019375, 0.23349253653835480876},
                                                                 {0.58731795428661744730, 0.20316742672306592175},
                                                                 {0.76990267419430468704, 0.16007832854334622633},
                                                                 {0.90411725637047485668, 0.10693932599531843096},
                                                                 {0.98156063424671925069, 0.04717533638651182720}}};

}  // namespace truncated

/// Of [low, high], low <= high: however narrow (a point counts as of the least mass that is a number), and however far
/// out in a tail, to about twelve digits (the mass to fourteen). Bounds beyond 1e100 count as that.
TruncatedNormal truncated_normal(double low, double high);

/// A Gaussian signal of which a value in multiples of a quantum is recorded, and what is known of it then.
struct SignalLikelihood {
  /// Log of the interval's mean density, log(mass / q): what a density is in the limit of q = 0, so that scores of
  /// coarser and finer data have one unit. Between models of the same data it differs as the log of the mass.
  double log_density = 0.0;
  /// Of the standardised innovation given the measurement: mean m, variance v and third and fourth central moments. Of
  /// u = sqrt(s) times it, of mean M and variance V, they are the derivatives, too (an exponential family's cumulants):
  ///   d log_density / de = -m / sqrt(s)    d log_density / ds = (v + m^2 - 1) / 2s
  ///   dM/de = 1 - v                        dM/ds = (2 m v + third) / 2 sqrt(s)
  ///   dV/de = -sqrt(s) third               dV/ds = (2 m third + fourth - v^2) / 2
  double mean = 0.0, variance = 0.0, third = 0.0, fourth = 0.0;
};

/// Of innovation `e` of variance `s` > 0; a signal of quantum zero is measured as it stands.
SignalLikelihood signal_likelihood(double e, double s, double quantum);

}  // namespace modebank
