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

#include "mixture/em_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

/// No product of eight pivots beyond double precision.
inline constexpr double largest_pivot = 1e37;
inline constexpr int pivots_per_log = 8;
/// Of an error so large in some direction that less than this of T's diagonal is left in another, rounding has the say;
/// such a point counts as unknown there, too.
inline constexpr double smallest_pivot_ratio = 1e-12;

constexpr int triangle(int features) { return features * (features + 1) / 2; }
constexpr int at(int i, int j) { return i * (i + 1) / 2 + j; }

/// Work arrays of one vector of points, of the sizes given; F known at compile time, where they become registers, or
/// not.
template <int F>
struct ErrorArrays {
  V x[F], s[triangle(F)], a[F * F], t[triangle(F)], m[triangle(F)], inverse_pivot[F], y[F], z[F];
  ErrorArrays(int, double*) {}
  static constexpr int features(int) { return F; }
};
template <>
struct ErrorArrays<0> {
  V *x, *s, *a, *t, *m, *inverse_pivot, *y, *z;
  ErrorArrays(int n, double* work) {
    V* next = reinterpret_cast<V*>(work);
    const auto take = [&](int count) {
      V* const taken = next;
      next += count;
      return taken;
    };
    x = take(n), s = take(triangle(n)), a = take(n * n), t = take(triangle(n)), m = take(triangle(n));
    inverse_pivot = take(n), y = take(n), z = take(n);
  }
  static int features(int n) { return n; }
};
HWY_INLINE Index error_work(int n) { return (4 * n + n * n + 3 * triangle(n)) * L; }

/// The lower triangle of t = I + W s W', and y = W (x - mean).
template <class Arrays>
HWY_INLINE void whiten(int n, const double* mean, const double* W, Arrays& v) {
  for (int i = 0; i < n; ++i) {
    V y = zero();
    for (int j = 0; j <= i; ++j) y = hn::MulAdd(splat(W[at(i, j)]), hn::Sub(v.x[j], splat(mean[j])), y);
    v.y[i] = y;
    for (int j = 0; j < n; ++j) {
      V sum = zero();
      for (int l = 0; l <= i; ++l) sum = hn::MulAdd(splat(W[at(i, l)]), v.s[l < j ? at(j, l) : at(l, j)], sum);
      v.a[i * n + j] = sum;
    }
    for (int j = 0; j <= i; ++j) {
      V sum = splat(i == j ? 1.0 : 0.0);
      for (int l = 0; l <= j; ++l) sum = hn::MulAdd(v.a[i * n + l], splat(W[at(j, l)]), sum);
      v.t[at(i, j)] = sum;
    }
  }
}

/// L D L' of t in place (unit lower triangle), pivots inverted; returns log det.
template <class Arrays>
HWY_INLINE V factor(int n, Arrays& v) {
  V product = splat(1.0), log_determinant = zero();
  for (int j = 0; j < n; ++j) {
    const V noticeable = hn::Max(hn::Mul(v.t[at(j, j)], splat(smallest_pivot_ratio)), splat(1.0));
    for (int k = 0; k < j; ++k) {
      V sum = v.t[at(j, k)];
      for (int i = 0; i < k; ++i) sum = hn::NegMulAdd(v.z[i], v.t[at(k, i)], sum);
      v.z[k] = sum;  // l_jk d_k
    }
    V pivot = v.t[at(j, j)];
    for (int k = 0; k < j; ++k) {
      const V l = hn::Mul(v.z[k], v.inverse_pivot[k]);
      v.t[at(j, k)] = l;
      pivot = hn::NegMulAdd(v.z[k], l, pivot);
    }
    pivot = hn::Min(hn::Max(pivot, noticeable), splat(largest_pivot));
    v.inverse_pivot[j] = hn::Div(splat(1.0), pivot);
    product = hn::Mul(product, pivot);
    if (j % pivots_per_log == pivots_per_log - 1 || j == n - 1) {
      log_determinant = hn::Add(log_determinant, hn::Log(D(), product));
      product = splat(1.0);
    }
  }
  return log_determinant;
}

/// m = the inverse of the unit lower triangle in t.
template <class Arrays>
HWY_INLINE void invert(int n, Arrays& v) {
  for (int j = 0; j < n; ++j) {
    v.m[at(j, j)] = splat(1.0);
    for (int i = j + 1; i < n; ++i) {
      V sum = v.t[at(i, j)];
      for (int k = j + 1; k < i; ++k) sum = hn::MulAdd(v.t[at(i, k)], v.m[at(k, j)], sum);
      v.m[at(i, j)] = hn::Neg(sum);
    }
  }
}

/// z = T^-1 y and I - T^-1 to `out`; returns y' T^-1 y.
template <class Arrays>
HWY_INLINE V expected(int n, Arrays& v, double* out) {
  V distance = zero();
  for (int i = n - 1; i >= 0; --i) {
    V u = v.y[i];
    for (int j = 0; j < i; ++j) u = hn::MulAdd(v.m[at(i, j)], v.y[j], u);
    const V scaled = hn::Mul(u, v.inverse_pivot[i]);
    distance = hn::MulAdd(u, scaled, distance);
    v.y[i] = scaled;  // entries below i are not needed any more in what they were
  }
  for (int i = 0; i < n; ++i) {
    V z = v.y[i];
    for (int l = i + 1; l < n; ++l) z = hn::MulAdd(v.m[at(l, i)], v.y[l], z);
    store(z, out + i * L);
    for (int j = 0; j <= i; ++j) {
      V sum = splat(i == j ? 1.0 : 0.0);
      for (int l = i; l < n; ++l) sum = hn::NegMulAdd(hn::Mul(v.m[at(l, i)], v.inverse_pivot[l]), v.m[at(l, j)], sum);
      store(sum, out + (n + at(i, j)) * L);
    }
  }
  return bounded(distance);
}

template <int F>
struct Errors {
  /// Log densities of one vector of points; expectations of component k at expectations + k stride.
  static HWY_INLINE void log_densities(const Components& components, const Block& block, const Scratch& scratch,
                                       Index point, double* expectations) {
    const int n = ErrorArrays<F>::features(components.features);
    ErrorArrays<F> v(n, scratch.work);
    for (int i = 0; i < n; ++i) v.x[i] = load(block.points + i * block_size + point);
    for (int i = 0; i < triangle(n); ++i) v.s[i] = load(block.errors + i * block_size + point);
    V top = zero();
    for (int k = 0; k < components.count; ++k) {
      whiten(n, components.means + k * n, components.whitening + k * components.stride, v);
      const V log_determinant = factor(n, v);
      invert(n, v);
      const V distance = expected(n, v, expectations + k * (n + triangle(n)) * L);
      const V density =
          hn::NegMulAdd(hn::Add(distance, log_determinant), splat(0.5), splat(components.log_constants[k]));
      store(density, scratch.relative + k * block_size + point);
      top = k == 0 ? density : hn::Max(top, density);
    }
    store(top, scratch.log_density + point);
  }

  static void evaluate(const Components& components, const Block& block, const Scratch& scratch) {
    double* expectations = scratch.work + error_work(components.features);
    for (Index point = 0; point < block_size; point += L)
      log_densities(components, block, scratch, point, expectations);
    normalise(add_noise(components, block, scratch), scratch);
  }

  static HWY_INLINE void add_component(int n, V r, const double* expectations, double* lanes) {
    add_to(lanes, r);
    for (int i = 0; i < n; ++i) {
      const V z = load(expectations + i * L), rz = hn::Mul(r, z);
      add_to(lanes + (1 + i) * L, rz);
      for (int j = 0; j <= i; ++j) {
        const V second = hn::MulAdd(z, load(expectations + j * L), load(expectations + (n + at(i, j)) * L));
        double* sum = lanes + (1 + n + at(i, j)) * L;
        store(hn::MulAdd(r, second, load(sum)), sum);
      }
    }
  }

  /// The expectations of a block are K (F + F (F + 1) / 2) columns: they are kept from the first pass to the second.
  static void accumulate(const Components& components, const Block& block, const Scratch& scratch) {
    const int n = ErrorArrays<F>::features(components.features);
    const Index per_component = (n + triangle(n)) * L, per_vector = components.count * per_component;
    double* expectations = scratch.work + error_work(n);
    for (Index point = 0; point < block_size; point += L)
      log_densities(components, block, scratch, point, expectations + point / L * per_vector);
    normalise(add_noise(components, block, scratch), scratch);
    begin_sums(components, block, scratch);
    for (int k = 0; k < components.count; ++k) {
      double* lanes = scratch.lanes + (2 + k * (1 + n + triangle(n))) * L;
      for (Index point = 0; point < block_size; point += L) {
        const V r = hn::Mul(load(scratch.relative + k * block_size + point), load(scratch.sum + point));
        add_component(n, r, expectations + point / L * per_vector + k * per_component, lanes);
      }
    }
  }
};

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
