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

// exp(x), x <= 0: 2^n times a polynomial in what is left of x. Cephes' split of log 2: n * high is exact.
inline constexpr double rounder = 6755399441055744.0;  // adding it leaves the integer in the low bits of the mantissa

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

/// n / 16 and a table of 2^(i/16) in two registers: degree 6 is enough.
struct Exp {
  V low, high;
  HWY_INLINE Exp() : low(load(sixteenth_powers)), high(load(sixteenth_powers + 8)) {}
  HWY_INLINE V operator()(V x) const {
    x = hn::Max(x, splat(smallest_log_ratio));
    const V shifted = hn::MulAdd(x, splat(16.0 * 1.4426950408889634074), splat(rounder));
    const V n = hn::Sub(shifted, splat(rounder));
    V r = hn::NegMulAdd(n, splat(6.93145751953125e-1 / 16), x);
    r = hn::NegMulAdd(n, splat(1.42860682030941723212e-6 / 16), r);
    const V power{_mm512_permutex2var_pd(low.raw, _mm512_castpd_si512(shifted.raw), high.raw)};
    V p = hn::MulAdd(r, splat(1.0 / 720), splat(1.0 / 120));
    p = hn::MulAdd(p, r, splat(1.0 / 24));
    p = hn::MulAdd(p, r, splat(1.0 / 6));
    p = hn::MulAdd(p, r, splat(0.5));
    p = hn::MulAdd(p, hn::Mul(r, r), r);
    const V y = hn::MulAdd(power, p, power);
    return V{_mm512_scalef_pd(y.raw, hn::Mul(n, splat(1.0 / 16)).raw)};  // scalef rounds its argument down
  }
};
#else
/// The Taylor polynomial of degree 12 on [-log(2)/2, log(2)/2].
struct Exp {
  HWY_INLINE V operator()(V x) const {
    x = hn::Max(x, splat(smallest_log_ratio));
    const V shifted = hn::MulAdd(x, splat(1.4426950408889634074), splat(rounder));
    const V n = hn::Sub(shifted, splat(rounder));
    V r = hn::NegMulAdd(n, splat(6.93145751953125e-1), x);
    r = hn::NegMulAdd(n, splat(1.42860682030941723212e-6), r);
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
