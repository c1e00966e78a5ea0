// Passes over the samples of one vector of consecutive windows, one window per lane. A lane's results depend on its own
// window alone: samples of neighbouring windows are masked.
#if defined(MODEBANK_BATCH_WINDOW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_WINDOW_INL
#undef MODEBANK_BATCH_WINDOW_INL
#else
#define MODEBANK_BATCH_WINDOW_INL
#endif

#include <hwy/highway.h>

#include <limits>

#include "ident/base/detail/simd-inl.hpp"
#include "ident/fit/detail/batch/loss-inl.hpp"
#include "ident/fit/detail/batch/problem.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Row i of window `lane` lies at [i * stride + lane].
struct View {
  const double* regressors[max_regressors];
  const double* increments;
  const double* present;  // flags of the transitions that are present; null if all are present
  Index stride;
  Index length;
};

HWY_INLINE V row(const View& view, const double* column, Index i) { return hn::LoadU(D(), column + i * view.stride); }

/// Sums of one pass over the samples at theta.
template <int Q>
struct Sums {
  V gradient[Q];         // sum psi phi: minus half the objective's gradient
  Symmetric<Q> hessian;  // sum slope phi phi'
  V cost;                // sum rho up to an offset
  V psi_square;
};

template <int Q>
HWY_INLINE V residual(const V& y, const V (&x)[Q], const V (&theta)[Q]) {
  V r = y;
  for (int j = 0; j < Q; ++j) r = hn::NegMulAdd(theta[j], x[j], r);
  return r;
}

template <int Q>
HWY_INLINE void add_outer(const V& factor, const V (&x)[Q], Symmetric<Q>& sum) {
  for (int i = 0; i < Q; ++i) {
    const V fx = hn::Mul(factor, x[i]);
    for (int j = 0; j <= i; ++j) sum.a[at(i, j)] = hn::MulAdd(fx, x[j], sum.a[at(i, j)]);
  }
}

template <int Q>
HWY_INLINE Symmetric<Q> zero_matrix() {
  Symmetric<Q> m;
  for (V& entry : m.a) entry = zero();
  return m;
}

/// The caller computes the Hessian of a quadratic loss, because it is constant.
template <int Q, class LossT>
HWY_INLINE Sums<Q> evaluate(const View& view, const LossT& loss, const V (&theta)[Q]) {
  Sums<Q> s{{}, zero_matrix<Q>(), zero(), zero()};
  for (V& entry : s.gradient) entry = zero();
  typename LossT::Cost cost;
  for (Index i = 0; i < view.length; ++i) {
    V x[Q];
    for (int j = 0; j < Q; ++j) x[j] = row(view, view.regressors[j], i);
    const V r = residual(row(view, view.increments, i), x, theta);
    const LossTerms at_r = loss.terms(r);
    for (int j = 0; j < Q; ++j) s.gradient[j] = hn::MulAdd(at_r.psi, x[j], s.gradient[j]);
    s.psi_square = hn::MulAdd(at_r.psi, at_r.psi, s.psi_square);
    cost.add(loss, r, at_r);
    if constexpr (!LossT::quadratic) add_outer(at_r.slope, x, s.hessian);
  }
  s.cost = cost.value(loss);
  return s;
}

/// sum rho' phi phi' at theta: the second derivative without rho''.
template <int Q, class LossT>
HWY_NOINLINE Symmetric<Q> reweighted_gram(const View& view, const LossT& loss, const V (&theta)[Q]) {
  Symmetric<Q> sum = zero_matrix<Q>();
  for (Index i = 0; i < view.length; ++i) {
    V x[Q];
    for (int j = 0; j < Q; ++j) x[j] = row(view, view.regressors[j], i);
    add_outer(loss.terms(residual(row(view, view.increments, i), x, theta)).weight, x, sum);
  }
  return sum;
}

/// Sums for least squares by normal equations: sum phi phi', sum phi y, sum y^2.
template <int Q>
struct NormalEquations {
  Symmetric<Q> gram;
  V moment[Q];
  V square_sum;
};

template <int Q>
HWY_INLINE NormalEquations<Q> normal_equations(const View& view) {
  NormalEquations<Q> n{zero_matrix<Q>(), {}, zero()};
  for (V& entry : n.moment) entry = zero();
  for (Index i = 0; i < view.length; ++i) {
    V x[Q];
    for (int j = 0; j < Q; ++j) x[j] = row(view, view.regressors[j], i);
    const V y = row(view, view.increments, i);
    for (int j = 0; j < Q; ++j) {
      n.moment[j] = hn::MulAdd(y, x[j], n.moment[j]);
      for (int k = 0; k <= j; ++k) n.gram.a[at(j, k)] = hn::MulAdd(x[j], x[k], n.gram.a[at(j, k)]);
    }
    n.square_sum = hn::MulAdd(y, y, n.square_sum);
  }
  return n;
}

/// Median of the first `count` sorted rows, per lane. For an even count it is the mean of the middle two.
HWY_INLINE V middle(const double* ordered, Index rows, V count, bool all_present) {
  const auto load = [&](Index i) HWY_ATTR { return hn::Load(D(), ordered + i * hn::Lanes(D())); };
  if (all_present)
    return rows % 2 == 1 ? load(rows / 2) : hn::Mul(splat(0.5), hn::Add(load(rows / 2 - 1), load(rows / 2)));
  const V upper = hn::Floor(hn::Mul(splat(0.5), count)),
          lower = hn::Floor(hn::Mul(splat(0.5), hn::Sub(count, splat(1.0))));
  V low = zero(), high = zero();
  for (Index i = 0; i < rows; ++i) {
    const V index = splat(static_cast<double>(i)), value = load(i);
    low = hn::IfThenElse(hn::Eq(index, lower), value, low);
    high = hn::IfThenElse(hn::Eq(index, upper), value, high);
  }
  return hn::IfThenElse(hn::Eq(lower, upper), high, hn::Mul(splat(0.5), hn::Add(low, high)));
}

HWY_INLINE void order(const std::vector<Comparator>& network, double* rows) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  for (const Comparator& c : network) {
    double *const low = rows + static_cast<std::size_t>(c.low) * lanes, *const high =
                                                                            rows +
                                                                            static_cast<std::size_t>(c.high) * lanes;
    const V a = hn::Load(d, low), b = hn::Load(d, high);
    hn::Store(hn::Min(a, b), d, low);
    hn::Store(hn::Max(a, b), d, high);
  }
}

/// 1.4826 median |r - median r| over the samples that are present. Overwrites the rows of residuals.
HWY_NOINLINE inline V normalised_mad(const Settings& settings, const View& view, double* rows, V count) {
  const D d;
  const Index lanes = static_cast<Index>(hn::Lanes(d));
  const bool all = view.present == nullptr;
  const V absent = splat(std::numeric_limits<double>::infinity());
  if (!all)
    for (Index i = 0; i < view.length; ++i) {
      const M here = hn::Gt(row(view, view.present, i), zero());
      hn::Store(hn::IfThenElse(here, hn::Load(d, rows + i * lanes), absent), d, rows + i * lanes);
    }
  const std::vector<Comparator>& network = all ? settings.median : settings.sort;
  order(network, rows);
  const V centre = middle(rows, view.length, count, all);
  for (Index i = 0; i < view.length; ++i)
    hn::Store(hn::Abs(hn::Sub(hn::Load(d, rows + i * lanes), centre)), d, rows + i * lanes);
  order(network, rows);
  return hn::Mul(splat(mad_to_sd), middle(rows, view.length, count, all));
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
