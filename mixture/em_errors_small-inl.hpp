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

/// Two vectors of points side by side: one's arithmetic fills the time in which the other's waits for its own.
struct Pair {
  V a, b;
};

namespace each {

HWY_INLINE Pair splat(double value) { return {em::HWY_NAMESPACE::splat(value), em::HWY_NAMESPACE::splat(value)}; }
HWY_INLINE Pair load(const double* from) { return {em::HWY_NAMESPACE::load(from), em::HWY_NAMESPACE::load(from + L)}; }
HWY_INLINE void store(Pair value, double* to, Index apart) {
  em::HWY_NAMESPACE::store(value.a, to);
  em::HWY_NAMESPACE::store(value.b, to + apart);
}
HWY_INLINE Pair Sub(Pair x, Pair y) { return {hn::Sub(x.a, y.a), hn::Sub(x.b, y.b)}; }
HWY_INLINE Pair Mul(Pair x, Pair y) { return {hn::Mul(x.a, y.a), hn::Mul(x.b, y.b)}; }
HWY_INLINE Pair Neg(Pair x) { return {hn::Neg(x.a), hn::Neg(x.b)}; }
HWY_INLINE Pair MulAdd(Pair x, Pair y, Pair z) { return {hn::MulAdd(x.a, y.a, z.a), hn::MulAdd(x.b, y.b, z.b)}; }
HWY_INLINE Pair NegMulAdd(Pair x, Pair y, Pair z) {
  return {hn::NegMulAdd(x.a, y.a, z.a), hn::NegMulAdd(x.b, y.b, z.b)};
}
HWY_INLINE Pair sound_pivot(Pair pivot, Pair least) {
  return {em::HWY_NAMESPACE::sound_pivot(pivot.a, least.a), em::HWY_NAMESPACE::sound_pivot(pivot.b, least.b)};
}
HWY_INLINE Pair noticeable_pivot(Pair diagonal) {
  return {em::HWY_NAMESPACE::noticeable_pivot(diagonal.a), em::HWY_NAMESPACE::noticeable_pivot(diagonal.b)};
}
HWY_INLINE Pair reciprocal(Pair x) {
  return {batch::HWY_NAMESPACE::reciprocal(x.a), batch::HWY_NAMESPACE::reciprocal(x.b)};
}

HWY_INLINE V Mul(V x, V y) { return hn::Mul(x, y); }
HWY_INLINE V Neg(V x) { return hn::Neg(x); }
HWY_INLINE V MulAdd(V x, V y, V z) { return hn::MulAdd(x, y, z); }
HWY_INLINE V NegMulAdd(V x, V y, V z) { return hn::NegMulAdd(x, y, z); }
HWY_INLINE V sound_pivot(V pivot, V least) { return em::HWY_NAMESPACE::sound_pivot(pivot, least); }
HWY_INLINE V reciprocal(V x) { return batch::HWY_NAMESPACE::reciprocal(x); }

}  // namespace each

template <int F, bool diagonal_>
struct SmallErrors {
  static constexpr bool diagonal = diagonal_;
  static constexpr int triangles = triangle(F);
  static constexpr int features(int) { return F; }
  static constexpr Index work(int) { return 0; }
  static constexpr Index per_vector = expectations(F, diagonal_) * L;

  SmallErrors(int, double*) {}

  Block block;
  void begin(const Block& points) { block = points; }

  /// The lower triangle of T and y. Packing::unit_rows.
  HWY_INLINE void whiten(const double* mean, const double* W, Pair (&t)[triangles], Pair (&y)[F]) const {
    const double *products = W, *D_ = W + triangles, *U = D_ + F;
    Pair x[F], s[triangles];
    for (int i = 0; i < F; ++i) x[i] = each::Sub(each::load(block.points + i * block_size), each::splat(mean[i]));
    for (int i = 0; i < triangles; ++i) s[i] = each::load(block.errors + i * block_size);
#pragma GCC unroll 4
    for (int i = 0; i < F; ++i) {
      Pair sum = x[i], a[F];
#pragma GCC unroll 4
      for (int l = 0; !diagonal && l < i; ++l) sum = each::MulAdd(each::splat(U[triangle(i - 1) + l]), x[l], sum);
      y[i] = each::Mul(sum, each::splat(D_[i]));
      // Row i of U S, then of U S U'.
#pragma GCC unroll 4
      for (int j = 0; j <= i; ++j) {
        a[j] = s[at(i, j)];
#pragma GCC unroll 4
        for (int l = 0; !diagonal && l < i; ++l)
          a[j] = each::MulAdd(each::splat(U[triangle(i - 1) + l]), s[l < j ? at(j, l) : at(l, j)], a[j]);
      }
#pragma GCC unroll 4
      for (int j = 0; j <= i; ++j) {
        Pair u = a[j];
#pragma GCC unroll 4
        for (int l = 0; !diagonal && l < j; ++l) u = each::MulAdd(a[l], each::splat(U[triangle(j - 1) + l]), u);
        t[at(i, j)] = i == j ? each::MulAdd(u, each::splat(products[at(i, j)]), each::splat(1.0))
                             : each::Mul(u, each::splat(products[at(i, j)]));
      }
    }
  }

  /// L D L' of t in place (unit lower triangle), pivots, which are at least `least`, inverted; returns the determinant.
  /// T: a vector or a pair of them.
  template <class T>
  static HWY_INLINE T factor(T (&t)[triangles], const T (&least)[F], T (&inverse_pivot)[F]) {
    T determinant;
#pragma GCC unroll 4
    for (int j = 0; j < F; ++j) {
      T z[F], pivot = t[at(j, j)];
#pragma GCC unroll 4
      for (int k = 0; k < j; ++k) {
        z[k] = t[at(j, k)];
#pragma GCC unroll 4
        for (int i = 0; i < k; ++i) z[k] = each::NegMulAdd(z[i], t[at(k, i)], z[k]);
      }
#pragma GCC unroll 4
      for (int k = 0; k < j; ++k) {
        t[at(j, k)] = each::Mul(z[k], inverse_pivot[k]);
        pivot = each::NegMulAdd(z[k], t[at(j, k)], pivot);
      }
      pivot = each::sound_pivot(pivot, least[j]);
      inverse_pivot[j] = each::reciprocal(pivot);
      determinant = j == 0 ? pivot : each::Mul(determinant, pivot);
    }
    return determinant;
  }

  /// The unit lower triangle in t becomes its inverse.
  template <class T>
  static HWY_INLINE void invert(T (&t)[triangles]) {
#pragma GCC unroll 4
    for (int i = 1; i < F; ++i)
#pragma GCC unroll 4
      for (int j = 0; j < i; ++j) {
        T sum = t[at(i, j)];
#pragma GCC unroll 4
        for (int k = j + 1; k < i; ++k) sum = each::MulAdd(t[at(i, k)], t[at(k, j)], sum);
        t[at(i, j)] = each::Neg(sum);
      }
  }

  /// z and I - T^-1 to `expected`, from the inverse of the factor; returns y' T^-1 y.
  static HWY_INLINE Pair expect(const Pair (&m)[triangles], const Pair (&inverse_pivot)[F], const Pair (&y)[F],
                                double* expected) {
    Pair u[F], scaled[F], distance;
#pragma GCC unroll 4
    for (int i = 0; i < F; ++i) {
      u[i] = y[i];
#pragma GCC unroll 4
      for (int j = 0; j < i; ++j) u[i] = each::MulAdd(m[at(i, j)], y[j], u[i]);
      scaled[i] = each::Mul(u[i], inverse_pivot[i]);
      distance = i == 0 ? each::Mul(u[i], scaled[i]) : each::MulAdd(u[i], scaled[i], distance);
    }
    double* second = expected + F * L;
#pragma GCC unroll 4
    for (int i = 0; i < F; ++i) {
      Pair z = scaled[i], row[F];
#pragma GCC unroll 4
      for (int l = i + 1; l < F; ++l) {
        z = each::MulAdd(m[at(l, i)], scaled[l], z);
        row[l] = each::Mul(m[at(l, i)], inverse_pivot[l]);
      }
      each::store(z, expected + i * L, per_vector);
#pragma GCC unroll 4
      for (int j = diagonal ? i : 0; j <= i; ++j, second += L) {
        Pair sum = i == j ? each::Sub(each::splat(1.0), inverse_pivot[i])
                          : each::Neg(each::Mul(m[at(i, j)], inverse_pivot[i]));
#pragma GCC unroll 4
        for (int l = i + 1; l < F; ++l) sum = each::NegMulAdd(row[l], m[at(l, j)], sum);
        each::store(sum, second, per_vector);
      }
    }
    return distance;
  }

  template <bool logarithmic>
  HWY_INLINE void spread(const double* mean, const double* W, double* expected, Spread<logarithmic> (&of)[2]) const {
    Pair t[triangles], y[F], least[F], inverse_pivot[F];
    whiten(mean, W, t, y);
    for (int i = 0; i < F; ++i) least[i] = i == 0 ? each::splat(1.0) : each::noticeable_pivot(t[at(i, i)]);
    const Pair determinant = factor(t, least, inverse_pivot);
    invert(t);
    const Pair distance = expect(t, inverse_pivot, y, expected);
    of[0] = {distance.a, part_of_determinant<logarithmic>(determinant.a)};
    of[1] = {distance.b, part_of_determinant<logarithmic>(determinant.b)};
  }
};

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
