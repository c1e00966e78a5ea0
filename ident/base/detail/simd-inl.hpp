// Small linear algebra, one problem per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_BATCH_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_LANES_INL
#undef MODEBANK_BATCH_LANES_INL
#else
#define MODEBANK_BATCH_LANES_INL
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

HWY_INLINE V splat(double value) { return hn::Set(D(), value); }
HWY_INLINE V zero() { return hn::Zero(D()); }
HWY_INLINE bool any(M mask) { return !hn::AllFalse(D(), mask); }
HWY_INLINE M none() { return hn::FirstN(D(), 0); }

/// 1 / x within one or two units in the last place. Neither x nor 1 / x may be denormal.
HWY_INLINE V reciprocal(V x) {
#if HWY_TARGET == HWY_AVX3
  V y{_mm512_rcp14_pd(x.raw)};
  const V e = hn::NegMulAdd(x, y, splat(1.0));
  y = hn::MulAdd(y, hn::MulAdd(e, e, e), y);  // a step of third order: from 14 to 42 correct bits
  return hn::MulAdd(y, hn::NegMulAdd(x, y, splat(1.0)), y);
#else
  return hn::Div(splat(1.0), x);
#endif
}

/// 1 / sqrt(x), with the accuracy and conditions of the reciprocal above.
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

/// Index of entry (i, j), i >= j, in a packed lower triangle.
constexpr int at(int i, int j) { return i * (i + 1) / 2 + j; }

/// A symmetric Q x Q matrix per lane, stored as its lower triangle.
template <int Q>
struct Symmetric {
  V a[Q * (Q + 1) / 2];
};

/// Factorisation L D L' of a symmetric matrix; stores the inverse of D.
template <int Q>
struct Ldl {
  V l[Q * (Q + 1) / 2];
  V inverse_d[Q];
  M ok;  ///< whether every pivot is above `least` times the diagonal element of `reference`
};

template <int Q>
HWY_INLINE Ldl<Q> factor(const Symmetric<Q>& A, const Symmetric<Q>& reference, double least) {
  Ldl<Q> f;
  V scaled[Q];  // l_jk d_k of row j
  f.ok = hn::Eq(zero(), zero());
  for (int j = 0; j < Q; ++j) {
    for (int k = 0; k < j; ++k) {
      V s = A.a[at(j, k)];
      for (int i = 0; i < k; ++i) s = hn::NegMulAdd(scaled[i], f.l[at(k, i)], s);
      scaled[k] = s;
    }
    V d = A.a[at(j, j)];
    for (int k = 0; k < j; ++k) {
      f.l[at(j, k)] = hn::Mul(scaled[k], f.inverse_d[k]);
      d = hn::NegMulAdd(scaled[k], f.l[at(j, k)], d);
    }
    f.ok = hn::And(f.ok, hn::Gt(d, hn::Mul(splat(least), reference.a[at(j, j)])));
    f.inverse_d[j] = hn::Div(splat(1.0), d);
  }
  return f;
}

template <int Q>
HWY_INLINE void solve(const Ldl<Q>& f, const V (&b)[Q], V (&x)[Q]) {
  for (int i = 0; i < Q; ++i) {
    x[i] = b[i];
    for (int k = 0; k < i; ++k) x[i] = hn::NegMulAdd(f.l[at(i, k)], x[k], x[i]);
  }
  for (int i = Q - 1; i >= 0; --i) {
    x[i] = hn::Mul(x[i], f.inverse_d[i]);
    for (int k = i + 1; k < Q; ++k) x[i] = hn::NegMulAdd(f.l[at(k, i)], x[k], x[i]);
  }
}

/// (L^-1)' D^-1 L^-1.
template <int Q>
HWY_INLINE Symmetric<Q> inverse(const Ldl<Q>& f) {
  Symmetric<Q> root, result;  // L^-1, whose diagonal is one
  for (int j = 0; j < Q; ++j)
    for (int i = j + 1; i < Q; ++i) {
      V sum = f.l[at(i, j)];
      for (int k = j + 1; k < i; ++k) sum = hn::MulAdd(f.l[at(i, k)], root.a[at(k, j)], sum);
      root.a[at(i, j)] = hn::Neg(sum);
    }
  for (int i = 0; i < Q; ++i)
    for (int j = 0; j <= i; ++j) {
      V sum = i == j ? f.inverse_d[i] : hn::Mul(f.inverse_d[i], root.a[at(i, j)]);
      for (int k = i + 1; k < Q; ++k)
        sum = hn::MulAdd(hn::Mul(f.inverse_d[k], root.a[at(k, i)]), root.a[at(k, j)], sum);
      result.a[at(i, j)] = sum;
    }
  return result;
}

/// x' A x.
template <int Q>
HWY_INLINE V quadratic_form(const Symmetric<Q>& A, const V (&x)[Q]) {
  V sum = zero();
  for (int i = 0; i < Q; ++i) {
    V row = hn::Mul(A.a[at(i, i)], x[i]);
    for (int j = 0; j < i; ++j) row = hn::MulAdd(hn::Add(A.a[at(i, j)], A.a[at(i, j)]), x[j], row);
    sum = hn::MulAdd(row, x[i], sum);
  }
  return sum;
}

template <int Q>
HWY_INLINE V dot(const V (&a)[Q], const V (&b)[Q]) {
  V sum = hn::Mul(a[0], b[0]);
  for (int i = 1; i < Q; ++i) sum = hn::MulAdd(a[i], b[i], sum);
  return sum;
}

/// Singular values of a Q x Q matrix by one-sided Jacobi rotations (Hestenes 1958). Small singular values are as
/// accurate as the matrix entries. A lane that needs no rotation is not changed.
template <int Q>
HWY_NOINLINE void singular_values(V (&column)[Q][Q], V (&sigma)[Q]) {
  constexpr double orthogonal = 1e-15;
  constexpr int max_sweeps = 12;
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    M rotated = none();
    for (int i = 0; i + 1 < Q; ++i)
      for (int j = i + 1; j < Q; ++j) {
        const V alpha = dot(column[i], column[i]), beta = dot(column[j], column[j]), gamma = dot(column[i], column[j]);
        const M needed = hn::Gt(hn::Mul(gamma, gamma), hn::Mul(splat(orthogonal * orthogonal), hn::Mul(alpha, beta)));
        if (!any(needed)) continue;
        rotated = hn::Or(rotated, needed);
        const V zeta = hn::Div(hn::Sub(beta, alpha), hn::Add(gamma, gamma));
        const V root = hn::Sqrt(hn::MulAdd(zeta, zeta, splat(1.0)));
        V t = hn::Div(splat(1.0), hn::Add(hn::Abs(zeta), root));
        t = hn::IfThenElseZero(needed, hn::CopySign(t, zeta));
        const V c = hn::Div(splat(1.0), hn::Sqrt(hn::MulAdd(t, t, splat(1.0)))), s = hn::Mul(c, t);
        for (int k = 0; k < Q; ++k) {
          const V a = column[i][k], b = column[j][k];
          column[i][k] = hn::NegMulAdd(s, b, hn::Mul(c, a));
          column[j][k] = hn::MulAdd(s, a, hn::Mul(c, b));
        }
      }
    if (!any(rotated)) break;
  }
  for (int j = 0; j < Q; ++j) sigma[j] = hn::Sqrt(dot(column[j], column[j]));
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
