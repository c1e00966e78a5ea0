// Moments of quantised signals (truncated_normal.hpp), one mode per lane. Included once per instruction set (Highway's
// foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_TRUNCATED_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_TRUNCATED_INL
#undef MODEBANK_VECTOR_IMM_TRUNCATED_INL
#else
#define MODEBANK_VECTOR_IMM_TRUNCATED_INL
#endif

#include <cmath>

#include "filter/step/detail/vector/mixture-inl.hpp"
#include "filter/step/truncated_normal.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// SignalLikelihood for one register of modes.
struct Signals {
  V log_density, mean, variance, third, fourth;
};

/// Moments of standard normal variables in [low, high], computed from differences. Intervals must be neither narrow nor
/// far from zero.
HWY_INLINE Signals by_differences(V low, V high) {
  const V beyond = splat(38.0);  // beyond this argument the density is denormal
  low = hn::Max(low, hn::Neg(beyond));
  high = hn::Min(high, beyond);
  const V mass = hn::Sub(normal_cdf(hn::Neg(low)), normal_cdf(hn::Neg(high)));
  const Exp exp;
  const V scale = hn::Div(splat(0.39894228040143267794), mass);
  const V at_low = hn::Mul(scale, exp(hn::Mul(splat(-0.5), hn::Mul(low, low))));
  const V at_high = hn::Mul(scale, exp(hn::Mul(splat(-0.5), hn::Mul(high, high))));
  Signals s;
  s.log_density = hn::Log(D(), mass);
  s.mean = hn::Sub(at_low, at_high);
  const V below = hn::Sub(low, s.mean), above = hn::Sub(high, s.mean);
  V from_low = hn::Mul(below, at_low), from_high = hn::Mul(above, at_high);
  s.variance = hn::Add(splat(1.0), hn::Sub(hn::Mul(low, at_low), hn::MulAdd(high, at_high, hn::Mul(s.mean, s.mean))));
  from_low = hn::Mul(below, from_low);
  from_high = hn::Mul(above, from_high);
  s.third = hn::NegMulAdd(s.mean, s.variance, hn::Sub(from_low, from_high));
  from_low = hn::Mul(below, from_low);
  from_high = hn::Mul(above, from_high);
  s.fourth = hn::NegMulAdd(s.mean, s.third, hn::MulAdd(splat(3.0), s.variance, hn::Sub(from_low, from_high)));
  return s;
}

/// Moments by Gauss-Legendre quadrature in panels. The lane that needs most panels sets their number for all lanes.
HWY_INLINE Signals by_quadrature(V low, V width) {
  constexpr double negligible = truncated::negligible_exponent;
  const V reach =
      hn::Div(splat(2.0 * negligible), hn::Add(low, hn::Sqrt(hn::MulAdd(low, low, splat(2.0 * negligible)))));
  width = hn::Min(width, reach);
  const V change = hn::Mul(hn::MulAdd(splat(0.5), width, hn::Abs(low)), width);
  const V panels = hn::Add(splat(1.0), hn::Floor(hn::Mul(change, splat(1.0 / truncated::most_per_panel))));
  const V half = hn::Div(hn::Mul(splat(0.5), width), panels);
  const double most = hn::GetLane(hn::MaxOfLanes(D(), panels));
  const Exp exp;
  V sum = zero(), first = zero(), second = zero(), third = zero(), fourth = zero();
  for (double panel = 0.0; panel < most; panel += 1.0) {
    const M there = hn::Lt(splat(panel), panels);
    for (const auto& [x, weight] : truncated::gauss)
      for (const double side : {-x, x}) {
        const V t = hn::Mul(half, splat(2.0 * panel + 1.0 + side));
        const V exponent = hn::Neg(hn::Mul(hn::MulAdd(splat(0.5), t, low), t));
        const V value = hn::IfThenElseZero(there, hn::Mul(splat(weight), exp(exponent)));
        const V linear = hn::Mul(value, t), square = hn::Mul(linear, t), cube = hn::Mul(square, t);
        sum = hn::Add(sum, value);
        first = hn::Add(first, linear);
        second = hn::Add(second, square);
        third = hn::Add(third, cube);
        fourth = hn::MulAdd(cube, t, fourth);
      }
  }
  const V inverse = hn::Div(splat(1.0), sum);
  const V m = hn::Mul(first, inverse), squares = hn::Mul(second, inverse), cubes = hn::Mul(third, inverse);
  const V m2 = hn::Mul(m, m);
  Signals s;
  s.log_density =
      hn::Add(hn::MulAdd(splat(-0.5), hn::Mul(low, low), splat(-0.5 * log_two_pi)), hn::Log(D(), hn::Mul(sum, half)));
  s.mean = hn::Add(low, m);
  s.variance = hn::Sub(squares, m2);
  s.third = hn::NegMulAdd(m, hn::NegMulAdd(splat(2.0), m2, hn::Mul(splat(3.0), squares)), cubes);
  const V inner = hn::MulSub(splat(6.0), squares, hn::Mul(splat(3.0), m2));
  s.fourth = hn::MulSub(fourth, inverse, hn::Mul(m, hn::NegMulAdd(m, inner, hn::Mul(splat(4.0), cubes))));
  return s;
}

HWY_INLINE Signals choose(M first, const Signals& a, const Signals& b) {
  const auto of = [first](V x, V y) { return hn::IfThenElse(first, x, y); };
  return {of(a.log_density, b.log_density), of(a.mean, b.mean), of(a.variance, b.variance), of(a.third, b.third),
          of(a.fourth, b.fourth)};
}

/// signal_likelihood of truncated_normal.hpp for innovations `e` with variances `s`.
HWY_INLINE Signals signal_likelihood(V e, V s, double quantum) {
  const V root = hn::Sqrt(s), z = hn::Div(e, root);
  if (quantum == 0.0)
    return {hn::NegMulAdd(splat(0.5), hn::MulAdd(z, z, hn::Log(D(), s)), splat(-0.5 * log_two_pi)), z, zero(), zero(),
            zero()};
  const V half = splat(0.5 * quantum), size = hn::Abs(e), furthest = splat(truncated::furthest);
  const V low = hn::Min(hn::Div(hn::Sub(size, half), root), furthest);
  const V high = hn::Min(hn::Div(hn::Add(size, half), root), furthest);
  const V width = hn::Div(splat(quantum), root);
  const M quadrature =
      hn::Or(hn::Lt(width, splat(truncated::least_width)), hn::Gt(low, splat(truncated::largest_start)));
  // Lanes that use the other method get an interval that is cheap to compute.
  Signals result;
  if (hn::AllTrue(D(), quadrature)) {
    result = by_quadrature(low, width);
  } else {
    result = by_differences(low, high);
    if (!hn::AllFalse(D(), quadrature))
      result = choose(quadrature,
                      by_quadrature(hn::IfThenElseZero(quadrature, low),
                                    hn::IfThenElse(quadrature, width, splat(truncated::least_width))),
                      result);
  }
  result.log_density = hn::Sub(result.log_density, splat(std::log(quantum)));
  result.variance = hn::Max(zero(), hn::Min(result.variance, splat(1.0)));
  const M mirrored = hn::Lt(e, zero());
  result.mean = hn::IfThenElse(mirrored, hn::Neg(result.mean), result.mean);
  result.third = hn::IfThenElse(mirrored, hn::Neg(result.third), result.third);
  return result;
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
