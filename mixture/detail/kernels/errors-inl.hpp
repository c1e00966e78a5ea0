// EM on points with error covariances (Bovy, Hogg & Roweis 2011), one point per lane, in coordinates in which the
// component's covariance is the identity: there the point's covariance is T = I + S' with S' = W S W', all eigenvalues
// of which are at least one, so its factorisation cannot break down. With y = W (x - mu) and z = T^-1 y the point
// without its error has expectation z and covariance I - T^-1 (eq. 15). Included once per instruction set.
#if defined(MODEBANK_EM_ERRORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_EM_ERRORS_INL
#undef MODEBANK_EM_ERRORS_INL
#else
#define MODEBANK_EM_ERRORS_INL
#endif

#include "mixture/detail/kernels/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

using batch::HWY_NAMESPACE::at;
using batch::HWY_NAMESPACE::reciprocal_root;

/// No product of four pivots beyond double precision.
inline constexpr double largest_pivot = 1e37;
/// Of an error so large in some direction that less than this of T's diagonal is left in another, rounding has the say;
/// such a point counts as unknown there, too.
inline constexpr double smallest_pivot_ratio = 1e-12;
/// Exponents relative to the shift of a block count as this at least: a point whose sum of densities is smaller than
/// its exponential is not left to the shift, and no product with a determinant's root gets denormal.
inline constexpr double smallest_exponent = -400.0;

/// Points between whose density and whose part in the sums nothing else is done, so that their expectations stay in
/// the nearest cache.
inline constexpr Index together = 2 * L;

constexpr int triangle(int features) { return features * (features + 1) / 2; }
constexpr int second_moments(int features, bool diagonal) { return diagonal ? features : triangle(features); }

/// What is expected of a point without its error: F of z, then I - T^-1, its lower triangle or its diagonal.
constexpr int expectations(int features, bool diagonal) { return features + second_moments(features, diagonal); }

/// A pivot of T: what rounding leaves of it is at least `noticeable`.
HWY_INLINE V sound_pivot(V pivot, V noticeable) { return hn::Min(hn::Max(pivot, noticeable), splat(largest_pivot)); }
HWY_INLINE V noticeable_pivot(V diagonal) {
  return hn::Max(hn::Mul(diagonal, splat(smallest_pivot_ratio)), splat(1.0));
}

/// One vector of points and one component: y' T^-1 y and the determinant of T, as its logarithm or the inverse of its
/// root.
template <bool logarithmic>
struct Spread {
  V distance, determinant;

  HWY_INLINE V density(double log_constant, double shift) const {
    if constexpr (logarithmic)
      return hn::NegMulAdd(hn::Add(bounded(distance), determinant), splat(0.5), splat(log_constant));
    const V exponent = hn::NegMulAdd(distance, splat(0.5), splat(log_constant - shift));
    return hn::Mul(Exp()(hn::Max(exponent, splat(smallest_exponent))), determinant);
  }
};

/// Log determinant, or the inverse of its root, from the determinant of at most four rows.
template <bool logarithmic>
HWY_INLINE V part_of_determinant(V determinant) {
  if constexpr (logarithmic) return Log()(determinant);
  return reciprocal_root(determinant);
}

/// From `point` on.
HWY_INLINE Block part(const Block& block, Index point) {
  return {block.points + point, block.weights + point, block.errors + point,
          block.noise ? block.noise + point : nullptr};
}
HWY_INLINE Scratch part(const Scratch& scratch, Index point) {
  return {scratch.relative + point, scratch.sum + point, scratch.log_density + point, scratch.lanes, scratch.work};
}

/// Of a few points: the sums of one component's r, r z and r (z z' + I - T^-1).
HWY_INLINE void add_expectations(int n, bool diagonal, const double* relative, const double* scale,
                                 const double* expected, double* lanes) {
  const Index per_vector = expectations(n, diagonal) * L;
  const V r0 = hn::Mul(load(relative), load(scale)), r1 = hn::Mul(load(relative + L), load(scale + L));
  const auto expected_at = [&](Index entry, V& a, V& b) {
    a = load(expected + entry * L);
    b = load(expected + per_vector + entry * L);
  };
  add_to(lanes, hn::Add(r0, r1));
  Index entry = n;
  for (int i = 0; i < n; ++i) {
    V z0, z1, s0, s1, other0, other1;
    expected_at(i, z0, z1);
    double* const first = lanes + (1 + i) * L;
    store(hn::MulAdd(r0, z0, hn::MulAdd(r1, z1, load(first))), first);
    for (int j = diagonal ? i : 0; j <= i; ++j, ++entry) {
      expected_at(j, other0, other1);
      expected_at(entry, s0, s1);
      double* const sum = lanes + (1 + entry) * L;
      store(hn::MulAdd(r0, hn::MulAdd(z0, other0, s0), hn::MulAdd(r1, hn::MulAdd(z1, other1, s1), load(sum))), sum);
    }
  }
}

/// The passes over a block. Kernel (Deconvolution): a constructor (features, work); `begin` (block), which reads two
/// vectors of points; `spread<logarithmic>` (component's mean, W, where expectations
/// go, the second vector's after all of the first's, and the two Spreads).
template <class Kernel>
struct Errors {
  template <bool logarithmic>
  static HWY_INLINE void densities(Kernel& kernel, const Components& components, double shift, const Scratch& scratch,
                                   double* expected) {
    const Index per_component = expectations(components.features, Kernel::diagonal) * together;
    V total[2];
    for (int k = 0; k < components.count; ++k) {
      Spread<logarithmic> spreads[2];
      kernel.template spread<logarithmic>(components.means + k * components.features,
                                          components.whitening + k * components.stride, expected + k * per_component,
                                          spreads);
      for (int v = 0; v < 2; ++v) {
        const V density = spreads[v].density(components.log_constants[k], shift);
        store(density, scratch.relative + k * block_size + v * L);
        total[v] = k == 0 ? density : logarithmic ? hn::Max(total[v], density) : hn::Add(total[v], density);
      }
    }
    for (int v = 0; v < 2; ++v) store(total[v], (logarithmic ? scratch.log_density : scratch.sum) + v * L);
  }

  /// relative, sum and log_density of `together` points.
  static HWY_INLINE void densities(Kernel& kernel, const Components& components, const Block& block, double shift,
                                   const Scratch& scratch, double* expected) {
    kernel.begin(block);
    densities<false>(kernel, components, shift, scratch, expected);
    if (finish_shifted(components, block, shift, scratch, together)) return;
    densities_anywhere(kernel, components, block, scratch, expected);
  }

  static HWY_NOINLINE void densities_anywhere(Kernel& kernel, const Components& components, const Block& block,
                                              const Scratch& scratch, double* expected) {
    densities<true>(kernel, components, 0.0, scratch, expected);
    normalise(add_noise(components, block, scratch, together), scratch, together);
  }

  static void evaluate(const Components& components, const Block& block, const Scratch& scratch) {
    Kernel kernel(components.features, scratch.work);
    const double shift = largest_log_constant(components);
    double* const expected = scratch.work + Kernel::Work::doubles(components.features);
    for (Index point = 0; point < block_size; point += together)
      densities(kernel, components, part(block, point), shift, part(scratch, point), expected);
  }

  static void accumulate(const Components& components, const Block& block, const Scratch& scratch) {
    const int n = components.features;
    Kernel kernel(n, scratch.work);
    const double shift = largest_log_constant(components);
    double* const expected = scratch.work + Kernel::Work::doubles(n);
    const Index entries = expectations(n, Kernel::diagonal);
    for (Index point = 0; point < block_size; point += together) {
      const Block points = part(block, point);
      const Scratch results = part(scratch, point);
      densities(kernel, components, points, shift, results, expected);
      begin_sums(components, points, results, together);
      double* lanes = scratch.lanes + 2 * L;
      for (int k = 0; k < components.count; ++k, lanes += (1 + entries) * L)
        add_expectations(n, Kernel::diagonal, results.relative + k * block_size, results.sum,
                         expected + k * entries * together, lanes);
    }
  }
};

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
