// Least squares, rank and scale of one vector of consecutive windows, one window per lane.
#if defined(MODEBANK_BATCH_START_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_START_INL
#undef MODEBANK_BATCH_START_INL
#else
#define MODEBANK_BATCH_START_INL
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "ident/fit/detail/batch/rotation-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// If every pivot of the normal equations is above this share of its diagonal element, their solution loses at most
/// four of sixteen digits.
inline constexpr double safe_pivot = 1e-4;

HWY_INLINE V sample_count(const View& view) {
  if (!view.present) return splat(static_cast<double>(view.length));
  V count = zero();
  for (Index i = 0; i < view.length; ++i) count = hn::Add(count, row(view, view.present, i));
  return count;
}

/// Smallest and largest eigenvalue of a positive definite matrix with unit diagonal and the given determinant. In three
/// dimensions the largest comes from the trigonometric formula (Smith 1961, Communications of the ACM 4). The other
/// eigenvalues come from the trace and the determinant, without cancellation.
struct Extremes {
  V least, largest;
};
HWY_INLINE Extremes correlation_extremes(const Symmetric<1>&, V) { return {splat(1.0), splat(1.0)}; }
HWY_INLINE Extremes correlation_extremes(const Symmetric<2>& C, V determinant) {
  const V largest = hn::Add(splat(1.0), hn::Abs(C.a[at(1, 0)]));
  return {hn::Div(determinant, largest), largest};
}
HWY_INLINE Extremes correlation_extremes(const Symmetric<3>& C, V determinant) {
  const V a = C.a[at(1, 0)], b = C.a[at(2, 0)], c = C.a[at(2, 1)], one = splat(1.0);
  // C - I has p = sqrt(tr(C - I)^2 / 6) and determinant 2 a b c.
  const V square = hn::Mul(splat(1.0 / 3.0), hn::MulAdd(a, a, hn::MulAdd(b, b, hn::Mul(c, c))));
  const V p = hn::Sqrt(square), cube = hn::Mul(square, p), product = hn::Mul(a, hn::Mul(b, c));
  const V r = hn::IfThenElseZero(hn::Gt(cube, zero()), hn::Div(product, cube));
  const V angle = hn::Mul(splat(1.0 / 3.0), hn::Acos(D(), hn::Max(hn::Min(r, one), hn::Neg(one))));
  const V largest = hn::MulAdd(hn::Add(p, p), hn::Cos(D(), angle), one);
  // sum and product of the other two eigenvalues
  const V sum = hn::Sub(splat(3.0), largest), rest = hn::Div(determinant, largest);
  const V root = hn::Sqrt(hn::Max(hn::NegMulAdd(splat(4.0), rest, hn::Mul(sum, sum)), zero()));
  return {hn::Div(hn::Add(rest, rest), hn::Add(sum, root)), largest};
}

/// A start from normal equations. `safe` excludes lanes that lose too many digits.
template <int Q>
HWY_INLINE M prepare_by_gram(const View& view, Start<Q>& start) {
  const NormalEquations<Q> n = normal_equations<Q>(view);
  const Ldl<Q> f = factor(n.gram, n.gram, safe_pivot);
  start.gram = n.gram;
  start.square_sum = n.square_sum;
  start.unscaled = inverse(f);
  for (int j = 0; j < Q; ++j) start.moment[j] = n.moment[j];
  solve(f, n.moment, start.theta);
  V scale[Q], determinant = splat(1.0);
  Symmetric<Q> correlation;
  for (int i = 0; i < Q; ++i) {
    scale[i] = hn::Div(splat(1.0), hn::Sqrt(n.gram.a[at(i, i)]));
    determinant = hn::Mul(determinant, hn::Div(hn::Mul(scale[i], scale[i]), f.inverse_d[i]));
    for (int j = 0; j <= i; ++j) correlation.a[at(i, j)] = hn::Mul(n.gram.a[at(i, j)], hn::Mul(scale[i], scale[j]));
  }
  const Extremes extremes = correlation_extremes(correlation, determinant);
  start.condition = hn::Sqrt(hn::Div(extremes.largest, extremes.least));
  start.rank = splat(Q);
  start.clear = f.ok;
  start.deficient = none();
  return f.ok;
}

HWY_INLINE void take(M lanes, V other, V& value) { value = hn::IfThenElse(lanes, other, value); }

/// Copies the lanes of `other` into `start`.
template <int Q>
HWY_NOINLINE void take(M lanes, const Start<Q>& other, Start<Q>& start) {
  for (int i = 0; i < at(Q, 0); ++i) {
    take(lanes, other.gram.a[i], start.gram.a[i]);
    take(lanes, other.unscaled.a[i], start.unscaled.a[i]);
  }
  for (int j = 0; j < Q; ++j) {
    take(lanes, other.moment[j], start.moment[j]);
    take(lanes, other.theta[j], start.theta[j]);
  }
  take(lanes, other.square_sum, start.square_sum);
  take(lanes, other.rank, start.rank);
  take(lanes, other.condition, start.condition);
  start.clear = hn::Or(hn::And(lanes, other.clear), hn::AndNot(lanes, start.clear));
  start.deficient = hn::Or(hn::And(lanes, other.deficient), hn::AndNot(lanes, start.deficient));
}

/// Least squares, rank and scale. Well-conditioned lanes (the usual case) use normal equations; the other lanes use
/// orthogonalisation.
template <int Q>
HWY_NOINLINE Start<Q> prepare(const Settings& settings, const View& view, M wanted, double* scratch) {
  const D d;
  const bool own_scale = settings.sigma == 0.0;
  const Index lanes = static_cast<Index>(hn::Lanes(d));
  double* const rows = scratch + view.length * lanes * (Q + 1);
  Start<Q> start;
  M unsafe = wanted;
  if constexpr (Q <= 3) {
    unsafe = hn::AndNot(prepare_by_gram(view, start), wanted);
    if (own_scale)
      for (Index i = 0; i < view.length; ++i) {
        V x[Q];
        for (int j = 0; j < Q; ++j) x[j] = row(view, view.regressors[j], i);
        hn::Store(residual(row(view, view.increments, i), x, start.theta), d, rows + i * lanes);
      }
  }
  if (any(unsafe)) {
    Start<Q> other;
    prepare_by_rotation(view, scratch, other);
    if (Q <= 3)
      take(unsafe, other, start);
    else
      start = other;
    if (own_scale)
      for (Index i = 0; i < view.length; ++i) {
        const V r = hn::Load(d, scratch + (i * (Q + 1) + Q) * lanes);
        hn::Store(hn::IfThenElse(unsafe, r, hn::Load(d, rows + i * lanes)), d, rows + i * lanes);
      }
  }
  start.count = sample_count(view);
  start.sigma = splat(settings.sigma);
  if (!own_scale) return start;
  const V mad = normalised_mad(settings, view, rows, start.count);
  const V factor = hn::Sqrt(hn::Div(start.count, hn::Sub(start.count, start.rank)));
  start.sigma = hn::Max(hn::Mul(mad, factor), splat(settings.floor));
  return start;
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
