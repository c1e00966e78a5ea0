// Elementary functions of vectors of doubles that Highway lacks or that need less than its generality. Included once
// per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_MATH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_MATH_INL
#undef MODEBANK_VECTOR_MATH_INL
#else
#define MODEBANK_VECTOR_MATH_INL
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_math::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

HWY_INLINE V splat(double value) { return hn::Set(D(), value); }

/// 1 / x to the last bit or two; x neither denormal nor so large that its reciprocal is.
HWY_INLINE V reciprocal(V x) {
#if HWY_TARGET == HWY_AVX3
  V y{_mm512_rcp14_pd(x.raw)};
  const V e = hn::NegMulAdd(x, y, splat(1.0));
  y = hn::MulAdd(y, hn::MulAdd(e, e, e), y);  // third order: 14 -> 42 bits
  return hn::MulAdd(y, hn::NegMulAdd(x, y, splat(1.0)), y);
#else
  return hn::Div(splat(1.0), x);
#endif
}

/// 1 / sqrt(x), likewise.
HWY_INLINE V reciprocal_root(V x) {
#if HWY_TARGET == HWY_AVX3
  V y{_mm512_rsqrt14_pd(x.raw)};
  for (int i = 0; i < 2; ++i) {
    const V e = hn::NegMulAdd(hn::Mul(x, y), y, splat(1.0));
    y = hn::MulAdd(hn::Mul(y, e), hn::MulAdd(e, splat(0.375), splat(0.5)), y);  // third order
  }
  return y;
#else
  return hn::Div(splat(1.0), hn::Sqrt(x));
#endif
}

/// Exponents below this count as this: no denormal numbers, which are slow.
inline constexpr double smallest_exponent = -690.0;

// exp(x) for |x| up to 690: 2^(n + r) with n a whole number (of sixteenths), r by the Taylor polynomial. log2(e) is the
// sum of two doubles.
inline constexpr double log2_e = 1.4426950408889634074, log2_e_rest = 2.0355273740931033e-17;

#if HWY_TARGET == HWY_AVX3
alignas(64) inline constexpr double sixteenth_powers[16] = {1.0,
                                                            1.0442737824274138,
                                                            1.0905077326652577,
                                                            1.1387886347566916,
                                                            1.189207115002721,
                                                            1.241857812073484,
                                                            1.2968395546510096,
                                                            1.3542555469368927,
                                                            1.4142135623730951,
                                                            1.4768261459394993,
                                                            1.5422108254079407,
                                                            1.6104903319492543,
                                                            1.681792830507429,
                                                            1.7562521603732995,
                                                            1.8340080864093424,
                                                            1.9152065613971474};

/// A table of 2^(i/16) in two registers: degree 6 is enough.
struct Exp {
  V low, high;
  HWY_INLINE Exp() : low(hn::Load(D(), sixteenth_powers)), high(hn::Load(D(), sixteenth_powers + 8)) {}
  HWY_INLINE V operator()(V x) const {
    // Adding it leaves the sixteenths in the low bits of the mantissa.
    const V rounder = splat(6755399441055744.0 / 16.0);
    x = hn::Max(x, splat(smallest_exponent));
    const V shifted = hn::MulAdd(x, splat(log2_e), rounder);
    const V n = hn::Sub(shifted, rounder);
    const V r = hn::MulAdd(x, splat(log2_e_rest), hn::MulSub(x, splat(log2_e), n));
    const V power{_mm512_permutex2var_pd(low.raw, _mm512_castpd_si512(shifted.raw), high.raw)};
    const V r2 = hn::Mul(r, r);
    const auto pair = [&](double a, double b) { return hn::MulAdd(r, splat(b), splat(a)); };
    const V high_terms = hn::MulAdd(r2, pair(1.3333558146428443e-3, 1.5403530393381609e-4),
                                    pair(5.5504108664821580e-2, 9.6181291076284772e-3));
    const V p = hn::MulAdd(r2, high_terms, pair(6.9314718055994531e-1, 2.4022650695910071e-1));
    const V y = hn::MulAdd(hn::Mul(power, r), p, power);
    return V{_mm512_scalef_pd(y.raw, n.raw)};  // scalef rounds its argument down
  }
};
#else
/// The polynomial of degree 12 on [-1/2, 1/2].
struct Exp {
  HWY_INLINE V operator()(V x) const {
    const V rounder = splat(6755399441055744.0);  // adding it leaves n in the low bits of the mantissa
    x = hn::Max(x, splat(smallest_exponent));
    const V shifted = hn::MulAdd(x, splat(log2_e), rounder);
    const V n = hn::Sub(shifted, rounder);
    // In natural units: Taylor's coefficients.
    const V fraction = hn::MulAdd(x, splat(log2_e_rest), hn::MulSub(x, splat(log2_e), n));
    const V r = hn::Mul(fraction, splat(0.69314718055994530942));
    const V r2 = hn::Mul(r, r), r4 = hn::Mul(r2, r2);
    const auto pair = [&](double a, double b) { return hn::MulAdd(r, splat(b), splat(a)); };
    const V low = hn::MulAdd(r2, pair(1.0 / 24, 1.0 / 120), pair(1.0 / 2, 1.0 / 6));
    const V middle = hn::MulAdd(r2, pair(1.0 / 40320, 1.0 / 362880), pair(1.0 / 720, 1.0 / 5040));
    const V high = hn::MulAdd(r2, splat(1.0 / 479001600), pair(1.0 / 3628800, 1.0 / 39916800));
    const V p = hn::MulAdd(r2, hn::MulAdd(r4, hn::MulAdd(r4, high, middle), low), r);
    const hn::RebindToUnsigned<D> bits;
    const auto exponent = hn::Add(hn::BitCast(bits, shifted), hn::Set(bits, 1023));
    const V power = hn::BitCast(D(), hn::ShiftLeft<52>(exponent));
    return hn::MulAdd(power, p, power);
  }
};
#endif

}  // namespace modebank::vector_math::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
