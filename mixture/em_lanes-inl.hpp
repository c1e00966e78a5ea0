// Vectors, exp and log, and what a block's log densities become. Included once per instruction set (Highway's
// foreach_target.h).
#if defined(MODEBANK_EM_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_EM_LANES_INL
#undef MODEBANK_EM_LANES_INL
#else
#define MODEBANK_EM_LANES_INL
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "mixture/em_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

inline constexpr Index L = hn::MaxLanes(D());
static_assert(block_size % (2 * L) == 0 && L <= most_lanes);

HWY_INLINE V splat(double value) { return hn::Set(D(), value); }
HWY_INLINE V zero() { return hn::Zero(D()); }
HWY_INLINE V load(const double* from) { return hn::Load(D(), from); }
HWY_INLINE void store(V value, double* to) { hn::Store(value, D(), to); }
HWY_INLINE void add_to(double* sum, V value) { store(hn::Add(load(sum), value), sum); }

/// Relative densities below exp(-690) count as that: no denormal numbers, which are slow.
inline constexpr double smallest_log_ratio = -690.0;
/// Squared distances beyond this (points so far out that squares overflow, or not a number where the parts of a
/// distance overflow with different signs) count as this, so that no density is ever NaN.
inline constexpr double largest_distance = 2e300;

HWY_INLINE V bounded(V distance) {
  const V largest = splat(largest_distance);
  return hn::IfThenElse(hn::Lt(distance, largest), distance, largest);
}

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
  HWY_INLINE Exp() : low(load(sixteenth_powers)), high(load(sixteenth_powers + 8)) {}
  HWY_INLINE V operator()(V x) const {
    // Adding it leaves the sixteenths in the low bits of the mantissa.
    const V rounder = splat(6755399441055744.0 / 16.0);
    x = hn::Max(x, splat(smallest_log_ratio));
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
    x = hn::Max(x, splat(smallest_log_ratio));
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

/// scratch.relative holds log densities of `rows` components and scratch.log_density their largest; turns the former
/// into densities relative to the largest, and the latter into the log density of the mixture.
HWY_INLINE void normalise(int rows, const Scratch& scratch) {
  const Exp exp;
  for (int k = 0; k < rows; ++k) {
    double* relative = scratch.relative + k * block_size;
    for (Index n = 0; n < block_size; n += 2 * L) {
      const V a = exp(hn::Sub(load(relative + n), load(scratch.log_density + n)));
      const V b = exp(hn::Sub(load(relative + n + L), load(scratch.log_density + n + L)));
      store(a, relative + n);
      store(b, relative + n + L);
      store(k == 0 ? a : hn::Add(load(scratch.sum + n), a), scratch.sum + n);
      store(k == 0 ? b : hn::Add(load(scratch.sum + n + L), b), scratch.sum + n + L);
    }
  }
  for (Index n = 0; n < block_size; n += L) add_to(scratch.log_density + n, hn::Log(D(), load(scratch.sum + n)));
}

/// The noise component's row comes after those of the Gaussians.
HWY_INLINE int add_noise(const Components& components, const Block& block, const Scratch& scratch) {
  if (!block.noise) return components.count;
  double* row = scratch.relative + components.count * block_size;
  for (Index n = 0; n < block_size; n += L) {
    const V noise = load(block.noise + n);
    store(noise, row + n);
    store(hn::Max(load(scratch.log_density + n), noise), scratch.log_density + n);
  }
  return components.count + 1;
}

/// What densities are relative to where that is one number for a whole block: no log density lies above it.
HWY_INLINE double largest_log_constant(const Components& components) {
  double largest = components.log_constants[0];
  for (int k = 1; k < components.count; ++k)
    largest = components.log_constants[k] > largest ? components.log_constants[k] : largest;
  return largest;
}

/// Ends what densities relative to exp(shift) began: adds the noise component and turns their sums into log densities.
/// False where a point is too far from all components (or the noise too dense) for one shift to do.
HWY_INLINE bool finish_shifted(const Components& components, const Block& block, double shift, const Scratch& scratch) {
  const V least = splat(1e-150), most = splat(1e150), by = splat(shift);
  const Exp exp;
  auto sound = hn::Eq(by, by);
  for (Index n = 0; n < block_size; n += L) {
    V sum = load(scratch.sum + n);
    if (block.noise) {
      const V noise = exp(hn::Sub(load(block.noise + n), by));
      store(noise, scratch.relative + components.count * block_size + n);
      sum = hn::Add(sum, noise);
      store(sum, scratch.sum + n);
    }
    sound = hn::And(sound, hn::And(hn::Ge(sum, least), hn::Le(sum, most)));
    store(hn::Add(by, hn::Log(D(), sum)), scratch.log_density + n);
  }
  return hn::AllTrue(D(), sound);
}

/// Adds log-likelihood and noise of a block to the first two of the lane sums; leaves weight / sum in scratch.sum.
HWY_INLINE void begin_sums(const Components& components, const Block& block, const Scratch& scratch) {
  V likelihood = load(scratch.lanes), noise = load(scratch.lanes + L);
  const double* row = scratch.relative + components.count * block_size;
  for (Index n = 0; n < block_size; n += L) {
    const V weight = load(block.weights + n);
    likelihood = hn::MulAdd(weight, load(scratch.log_density + n), likelihood);
    const V scale = hn::Div(weight, load(scratch.sum + n));
    store(scale, scratch.sum + n);
    if (block.noise) noise = hn::MulAdd(scale, load(row + n), noise);
  }
  store(likelihood, scratch.lanes);
  store(noise, scratch.lanes + L);
}

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
