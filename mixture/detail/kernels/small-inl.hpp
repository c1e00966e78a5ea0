// EM on up to four features: all values of a component stay in registers. Included once per instruction set.
#if defined(MODEBANK_EM_SMALL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_EM_SMALL_INL
#undef MODEBANK_EM_SMALL_INL
#else
#define MODEBANK_EM_SMALL_INL
#endif

#include "mixture/detail/kernels/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

/// Number of vectors of points that are computed side by side.
inline constexpr int abreast = 4;
static_assert(block_size % (abreast * L) == 0);

/// The constants of a component's log density, copied to every lane. The squared distance is |A x + b|^2, in units of
/// log2.
template <int F, bool diagonal>
struct Ellipsoid {
  static constexpr int seconds = diagonal ? F : F * (F + 1) / 2;
  V mean[F], A[seconds], b[F];

  /// Loads component `k` in the layout Packing::affine.
  HWY_INLINE Ellipsoid(const Components& components, int k) {
    const double* packed = components.whitening + k * components.stride;
    for (int i = 0; i < F; ++i) mean[i] = splat(components.means[k * F + i]);
    for (int i = 0; i < seconds; ++i) A[i] = splat(packed[i]);
    for (int i = 0; i < F; ++i) b[i] = splat(packed[seconds + i]);
  }

  /// Row i of A times x, plus `y` if it is given.
  HWY_INLINE V row(int i, const V (&x)[F], const V* y) const {
    const int first = diagonal ? i : i * (i + 1) / 2, column = diagonal ? i : 0;
    V sum = y ? hn::MulAdd(A[first], x[column], *y) : hn::Mul(A[first], x[column]);
#pragma GCC unroll 4
    for (int j = column + 1; j <= i; ++j) sum = hn::MulAdd(A[first + j - column], x[j], sum);
    return sum;
  }

  /// `log2_density` minus the squared distance, for a vector of points.
  template <bool central>
  HWY_INLINE V log2_density(const double* points, V log2_density) const {
    V x[F];
    for (int i = 0; i < F; ++i) {
      x[i] = in_register(load(points + i * block_size));
      if constexpr (!central) x[i] = hn::Sub(x[i], mean[i]);
    }
#pragma GCC unroll 4
    for (int i = 0; i < F; ++i) {
      const V y = row(i, x, central ? &b[i] : nullptr);
      log2_density = hn::NegMulAdd(y, y, log2_density);
    }
    return log2_density;
  }
};

template <int F, bool diagonal>
struct Small {
  static constexpr int seconds = Ellipsoid<F, diagonal>::seconds;
  static constexpr int entries = 1 + F + seconds;
  /// Number of central components whose sums are computed together. It is limited so that the sums fit in registers.
  static constexpr int together = L == 8 ? (entries > 12       ? 1
                                            : 24 / entries > 4 ? 4
                                                               : 24 / entries)
                                         : (entries > 6        ? 1
                                            : 12 / entries > 4 ? 4
                                                               : 12 / entries);

  static Index work(int) { return entries * block_size; }

  static void log_densities(const Components& components, const Block& block, const Scratch& scratch) {
    for (int k = 0; k < components.count; ++k) {
      const Ellipsoid<F, diagonal> ellipsoid(components, k);
      const V constant = splat(components.log_constants[k]), unit = splat(ln_2);
      double* out = scratch.relative + k * block_size;
      for (Index n = 0; n < block_size; n += L) {
        const V distance = hn::Neg(ellipsoid.template log2_density<false>(block.points + n, zero()));
        const V density = hn::NegMulAdd(bounded(distance), unit, constant);
        store(density, out + n);
        store(k == 0 ? density : hn::Max(load(scratch.log_density + n), density), scratch.log_density + n);
      }
    }
  }

  template <bool central>
  static HWY_INLINE void log2_densities(const Ellipsoid<F, diagonal>& ellipsoid, const double* points, double constant,
                                        double* out) {
    const V c = splat(constant);
    for (Index n = 0; n < block_size; n += L) store(ellipsoid.template log2_density<central>(points + n, c), out + n);
  }

  /// Densities relative to exp(shift), and their sums over the components.
  static HWY_INLINE void densities(const Components& components, const Block& block, double shift,
                                   const Scratch& scratch) {
    const Exp exp;
    for (int k = 0; k < components.count; ++k) {
      const Ellipsoid<F, diagonal> ellipsoid(components, k);
      const double constant = (components.log_constants[k] - shift) * log2_e;
      double* out = scratch.relative + k * block_size;
      if (components.central[k])
        log2_densities<true>(ellipsoid, block.points, constant, out);
      else
        log2_densities<false>(ellipsoid, block.points, constant, out);
      // A separate loop: the processor overlaps several short dependency chains, but cannot speed up a single long
      // chain.
      for (Index n = 0; n < block_size; n += abreast * L) {
        V density[abreast];
        for (int v = 0; v < abreast; ++v) density[v] = load(out + n + v * L);
        exp.power_of_two(density);
        for (int v = 0; v < abreast; ++v) {
          double* const sum = scratch.sum + n + v * L;
          store(density[v], out + n + v * L);
          store(k == 0 ? density[v] : hn::Add(load(sum), density[v]), sum);
        }
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

  /// Adds a component's sums about its mean.
  static HWY_INLINE void add_component(const double* mean_values, const double* points, const double* relative,
                                       const double* scale, double* lanes) {
    V mean[F], d[F], sum[entries];
    for (int i = 0; i < F; ++i) mean[i] = splat(mean_values[i]);
    for (int i = 0; i < entries; ++i) sum[i] = load(lanes + i * L);
    for (Index n = 0; n < block_size; n += L) {
      const V r = hn::Mul(load(relative + n), load(scale + n));
      for (int i = 0; i < F; ++i) d[i] = hn::Sub(load(points + i * block_size + n), mean[i]);
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

  /// Fills one column per sum with the contribution of each point to a component of density one.
  static HWY_INLINE void moments(const double* points, const double* scale, double* columns) {
    for (Index n = 0; n < block_size; n += L) {
      const V s = load(scale + n);
      V x[F];
      store(s, columns + n);
      double* second = columns + (1 + F) * block_size + n;
      for (int i = 0; i < F; ++i) {
        x[i] = load(points + i * block_size + n);
        const V sx = hn::Mul(s, x[i]);
        store(sx, columns + (1 + i) * block_size + n);
        for (int j = diagonal ? i : 0; j <= i; ++j, second += block_size) store(hn::Mul(sx, x[j]), second);
      }
    }
  }

  /// Adds the sums of central components about the origin.
  template <int count>
  static HWY_INLINE void add_central(const double* columns, const int* components, const Scratch& scratch) {
    V sum[count][entries];
    const double* relative[count];
    double* lanes[count];
    for (int c = 0; c < count; ++c) {
      relative[c] = scratch.relative + components[c] * block_size;
      lanes[c] = scratch.lanes + (2 + components[c] * entries) * L;
      for (int i = 0; i < entries; ++i) sum[c][i] = load(lanes[c] + i * L);
    }
    for (Index n = 0; n < block_size; n += L) {
      V density[count];
      for (int c = 0; c < count; ++c) density[c] = load(relative[c] + n);
      for (int i = 0; i < entries; ++i) {
        const V moment = in_register(load(columns + i * block_size + n));
        for (int c = 0; c < count; ++c) sum[c][i] = hn::MulAdd(density[c], moment, sum[c][i]);
      }
    }
    for (int c = 0; c < count; ++c)
      for (int i = 0; i < entries; ++i) store(sum[c][i], lanes[c] + i * L);
  }

  static void accumulate(const Components& components, const Block& block, const Scratch& scratch) {
    evaluate(components, block, scratch);
    begin_sums(components, block, scratch);
    moments(block.points, scratch.sum, scratch.work);
    int waiting[together], count = 0;
    for (int k = 0; k < components.count; ++k) {
      if (!components.central[k]) {
        add_component(components.means + k * F, block.points, scratch.relative + k * block_size, scratch.sum,
                      scratch.lanes + (2 + k * entries) * L);
        continue;
      }
      waiting[count++] = k;
      if (count < together) continue;
      add_central<together>(scratch.work, waiting, scratch);
      count = 0;
    }
    for (int i = 0; i < count; ++i) add_central<1>(scratch.work, waiting + i, scratch);
  }
};

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
