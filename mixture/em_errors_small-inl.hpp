// EM with error covariances on up to four features: what concerns a point and a component stays in registers. Included
// once per instruction set.
#if defined(MODEBANK_EM_ERRORS_SMALL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_EM_ERRORS_SMALL_INL
#undef MODEBANK_EM_ERRORS_SMALL_INL
#else
#define MODEBANK_EM_ERRORS_SMALL_INL
#endif

#include "mixture/em_errors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

template <int F, bool diagonal_>
struct SmallErrors {
  static constexpr bool diagonal = diagonal_;
  static constexpr int triangles = triangle(F);
  static constexpr int features(int) { return F; }
  static constexpr Index work(int) { return 0; }

  SmallErrors(int, double*) {}

  Block block;
  void begin(const Block& points) { block = points; }

  /// The lower triangle of T and y. Packing::unit_rows.
  HWY_INLINE void whiten(Index point, const double* mean, const double* W, V (&t)[triangles], V (&y)[F]) const {
    const double *products = W, *D_ = W + triangles, *U = D_ + F;
    V x[F], s[triangles];
    for (int i = 0; i < F; ++i) x[i] = hn::Sub(load(block.points + i * block_size + point), splat(mean[i]));
    for (int i = 0; i < triangles; ++i) s[i] = load(block.errors + i * block_size + point);
#pragma GCC unroll 4
    for (int i = 0; i < F; ++i) {
      V sum = x[i], a[F];
#pragma GCC unroll 4
      for (int l = 0; !diagonal && l < i; ++l) sum = hn::MulAdd(splat(U[triangle(i - 1) + l]), x[l], sum);
      y[i] = hn::Mul(sum, splat(D_[i]));
      // Row i of U S, then of U S U'.
#pragma GCC unroll 4
      for (int j = 0; j <= i; ++j) {
        a[j] = s[at(i, j)];
#pragma GCC unroll 4
        for (int l = 0; !diagonal && l < i; ++l)
          a[j] = hn::MulAdd(splat(U[triangle(i - 1) + l]), s[l < j ? at(j, l) : at(l, j)], a[j]);
      }
#pragma GCC unroll 4
      for (int j = 0; j <= i; ++j) {
        V u = a[j];
#pragma GCC unroll 4
        for (int l = 0; !diagonal && l < j; ++l) u = hn::MulAdd(a[l], splat(U[triangle(j - 1) + l]), u);
        t[at(i, j)] =
            i == j ? hn::MulAdd(u, splat(products[at(i, j)]), splat(1.0)) : hn::Mul(u, splat(products[at(i, j)]));
      }
    }
  }

  /// L D L' of t in place (unit lower triangle), pivots, which are at least `least`, inverted; returns the determinant.
  static HWY_INLINE V factor(V (&t)[triangles], const V (&least)[F], V (&inverse_pivot)[F]) {
    V determinant;
#pragma GCC unroll 4
    for (int j = 0; j < F; ++j) {
      V z[F], pivot = t[at(j, j)];
#pragma GCC unroll 4
      for (int k = 0; k < j; ++k) {
        z[k] = t[at(j, k)];
#pragma GCC unroll 4
        for (int i = 0; i < k; ++i) z[k] = hn::NegMulAdd(z[i], t[at(k, i)], z[k]);
      }
#pragma GCC unroll 4
      for (int k = 0; k < j; ++k) {
        t[at(j, k)] = hn::Mul(z[k], inverse_pivot[k]);
        pivot = hn::NegMulAdd(z[k], t[at(j, k)], pivot);
      }
      pivot = sound_pivot(pivot, least[j]);
      inverse_pivot[j] = reciprocal(pivot);
      determinant = j == 0 ? pivot : hn::Mul(determinant, pivot);
    }
    return determinant;
  }

  /// The unit lower triangle in t becomes its inverse.
  static HWY_INLINE void invert(V (&t)[triangles]) {
#pragma GCC unroll 4
    for (int i = 1; i < F; ++i)
#pragma GCC unroll 4
      for (int j = 0; j < i; ++j) {
        V sum = t[at(i, j)];
#pragma GCC unroll 4
        for (int k = j + 1; k < i; ++k) sum = hn::MulAdd(t[at(i, k)], t[at(k, j)], sum);
        t[at(i, j)] = hn::Neg(sum);
      }
  }

  /// z and I - T^-1 to `expected`, from the inverse of the factor; returns y' T^-1 y.
  static HWY_INLINE V expect(const V (&m)[triangles], const V (&inverse_pivot)[F], const V (&y)[F], double* expected) {
    V u[F], scaled[F], distance;
#pragma GCC unroll 4
    for (int i = 0; i < F; ++i) {
      u[i] = y[i];
#pragma GCC unroll 4
      for (int j = 0; j < i; ++j) u[i] = hn::MulAdd(m[at(i, j)], y[j], u[i]);
      scaled[i] = hn::Mul(u[i], inverse_pivot[i]);
      distance = i == 0 ? hn::Mul(u[i], scaled[i]) : hn::MulAdd(u[i], scaled[i], distance);
    }
    double* second = expected + F * L;
#pragma GCC unroll 4
    for (int i = 0; i < F; ++i) {
      V z = scaled[i], row[F];
#pragma GCC unroll 4
      for (int l = i + 1; l < F; ++l) {
        z = hn::MulAdd(m[at(l, i)], scaled[l], z);
        row[l] = hn::Mul(m[at(l, i)], inverse_pivot[l]);
      }
      store(z, expected + i * L);
#pragma GCC unroll 4
      for (int j = diagonal ? i : 0; j <= i; ++j, second += L) {
        V sum = i == j ? hn::Sub(splat(1.0), inverse_pivot[i]) : hn::Neg(hn::Mul(m[at(i, j)], inverse_pivot[i]));
#pragma GCC unroll 4
        for (int l = i + 1; l < F; ++l) sum = hn::NegMulAdd(row[l], m[at(l, j)], sum);
        store(sum, second);
      }
    }
    return distance;
  }

  template <bool logarithmic>
  HWY_INLINE Spread<logarithmic> spread(int v, const double* mean, const double* W, double* expected) const {
    V t[triangles], y[F], least[F], inverse_pivot[F];
    whiten(v * L, mean, W, t, y);
    for (int i = 0; i < F; ++i) least[i] = i == 0 ? splat(1.0) : noticeable_pivot(t[at(i, i)]);
    const V determinant = part_of_determinant<logarithmic>(factor(t, least, inverse_pivot));
    invert(t);
    return {expect(t, inverse_pivot, y, expected), determinant};
  }
};

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
