// EM on up to four features: everything about a component stays in registers. Included once per instruction set.
#if defined(MODEBANK_EM_SMALL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_EM_SMALL_INL
#undef MODEBANK_EM_SMALL_INL
#else
#define MODEBANK_EM_SMALL_INL
#endif

#include "mixture/em_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

template <int F, bool diagonal>
struct Small {
  static constexpr int seconds = diagonal ? F : F * (F + 1) / 2;
  static constexpr int entries = 1 + F + seconds;

  static HWY_INLINE void offset(const double* points, Index n, const V (&mean)[F], V (&d)[F]) {
    for (int i = 0; i < F; ++i) d[i] = hn::Sub(load(points + i * block_size + n), mean[i]);
  }

  static HWY_INLINE V unbounded_distance(const V (&W)[seconds], const V (&d)[F]) {
    V sum = zero();
#pragma GCC unroll 4
    for (int i = 0; i < F; ++i) {
      V y;
      if constexpr (diagonal) {
        y = hn::Mul(W[i], d[i]);
      } else {
        const int row = i * (i + 1) / 2;
        y = hn::Mul(W[row], d[0]);
#pragma GCC unroll 4
        for (int j = 1; j <= i; ++j) y = hn::MulAdd(W[row + j], d[j], y);
      }
      sum = i == 0 ? hn::Mul(y, y) : hn::MulAdd(y, y, sum);
    }
    return sum;
  }

  static HWY_INLINE void log_densities(const Components& components, const Block& block, const Scratch& scratch) {
    for (int k = 0; k < components.count; ++k) {
      V mean[F], W[seconds], d[F];
      for (int i = 0; i < F; ++i) mean[i] = splat(components.means[k * F + i]);
      for (int i = 0; i < seconds; ++i) W[i] = splat(components.whitening[k * components.stride + i]);
      const V constant = splat(components.log_constants[k]), half = splat(0.5);
      double* out = scratch.relative + k * block_size;
      for (Index n = 0; n < block_size; n += L) {
        offset(block.points, n, mean, d);
        const V density = hn::NegMulAdd(bounded(unbounded_distance(W, d)), half, constant);
        store(density, out + n);
        store(k == 0 ? density : hn::Max(load(scratch.log_density + n), density), scratch.log_density + n);
      }
    }
  }

  static HWY_INLINE void add_component(const double* mean_values, const double* points, const double* relative,
                                       const double* scale, double* lanes) {
    V mean[F], d[F], sum[entries];
    for (int i = 0; i < F; ++i) mean[i] = splat(mean_values[i]);
    for (int i = 0; i < entries; ++i) sum[i] = load(lanes + i * L);
    for (Index n = 0; n < block_size; n += L) {
      const V r = hn::Mul(load(relative + n), load(scale + n));
      offset(points, n, mean, d);
      sum[0] = hn::Add(sum[0], r);
      int entry = 1 + F;
      for (int i = 0; i < F; ++i) {
        const V rd = hn::Mul(r, d[i]);
        sum[1 + i] = hn::Add(sum[1 + i], rd);
        for (int j = diagonal ? i : 0; j <= i; ++j, ++entry) sum[entry] = hn::MulAdd(rd, d[j], sum[entry]);
      }
    }
    for (int i = 0; i < entries; ++i) store(sum[i], lanes + i * L);
  }

  /// Densities relative to exp(shift) and their sums in one pass.
  static HWY_INLINE void densities(const Components& components, const Block& block, double shift,
                                   const Scratch& scratch) {
    const Exp exp;
    for (Index n = 0; n < block_size; n += L) store(zero(), scratch.sum + n);
    for (int k = 0; k < components.count; ++k) {
      V mean[F], W[seconds], d[F];
      for (int i = 0; i < F; ++i) mean[i] = splat(components.means[k * F + i]);
      for (int i = 0; i < seconds; ++i) W[i] = splat(components.whitening[k * components.stride + i]);
      const V constant = splat(components.log_constants[k] - shift), half = splat(0.5);
      double* out = scratch.relative + k * block_size;
      for (Index n = 0; n < block_size; n += L) {
        offset(block.points, n, mean, d);
        store(hn::NegMulAdd(unbounded_distance(W, d), half, constant), out + n);
      }
      // A loop of its own: the processor holds the short chains of several vectors at once, but not one long one.
      for (Index n = 0; n < block_size; n += L) {
        const V density = exp(load(out + n));
        store(density, out + n);
        store(hn::Add(load(scratch.sum + n), density), scratch.sum + n);
      }
    }
  }

  static void evaluate(const Components& components, const Block& block, const Scratch& scratch) {
    const double shift = largest_log_constant(components);
    densities(components, block, shift, scratch);
    if (finish_shifted(components, block, shift, scratch)) return;
    log_densities(components, block, scratch);
    normalise(add_noise(components, block, scratch), scratch);
  }

  static void accumulate(const Components& components, const Block& block, const Scratch& scratch) {
    evaluate(components, block, scratch);
    begin_sums(components, block, scratch);
    double* lanes = scratch.lanes + 2 * L;
    for (int k = 0; k < components.count; ++k, lanes += entries * L)
      add_component(components.means + k * F, block.points, scratch.relative + k * block_size, scratch.sum, lanes);
  }
};

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
