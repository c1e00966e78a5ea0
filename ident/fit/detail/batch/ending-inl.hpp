// Sums over the residuals at the optimum, and the covariances that follow from these sums.
#if defined(MODEBANK_BATCH_ENDING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_ENDING_INL
#undef MODEBANK_BATCH_ENDING_INL
#else
#define MODEBANK_BATCH_ENDING_INL
#endif

#include <hwy/highway.h>

#include "ident/fit/detail/batch/start-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Sums over the residuals at the optimum. omega = rho' is the robust weight of a sample, y its increment.
struct Ending {
  V psi_square, slope, slope_square, weighted_square, inliers;
  V omega, omega_y, omega_y_square;  // y is taken relative to the window's first increment
};

/// An absent transition must not change the sums. Its residual is set to zero: then slope and omega are 1.
template <int Q, class LossT>
HWY_NOINLINE Ending residual_sums(const View& view, const LossT& loss, const V (&theta)[Q]) {
  Ending e{zero(), zero(), zero(), zero(), zero(), zero(), zero(), zero()};
  const V one = splat(1.0), first = row(view, view.increments, 0);
  for (Index i = 0; i < view.length; ++i) {
    V x[Q];
    for (int j = 0; j < Q; ++j) x[j] = row(view, view.regressors[j], i);
    const V y = row(view, view.increments, i), r = residual(y, x, theta);
    const LossTerms t = loss.terms(r);
    const V here = view.present ? row(view, view.present, i) : one;
    const V omega = hn::Mul(here, t.weight), about = hn::Sub(y, first);
    e.psi_square = hn::MulAdd(t.psi, t.psi, e.psi_square);
    e.slope = hn::MulAdd(here, t.slope, e.slope);
    e.slope_square = hn::MulAdd(here, hn::Mul(t.slope, t.slope), e.slope_square);
    e.weighted_square = hn::MulAdd(hn::Mul(t.weight, r), r, e.weighted_square);
    e.inliers = hn::Add(e.inliers, hn::IfThenElseZero(hn::Ge(t.weight, splat(inlier_weight)), here));
    e.omega = hn::Add(e.omega, omega);
    e.omega_y = hn::MulAdd(omega, about, e.omega_y);
    e.omega_y_square = hn::MulAdd(hn::Mul(omega, about), about, e.omega_y_square);
  }
  return e;
}

/// Number of parameters that the data determine: the sum of the samples' leverages, computed with sigma.
template <int Q>
HWY_INLINE V data_parameters(const Settings& settings, const Surroundings<Q>& around) {
  V f = splat(Q);
  if (!settings.prior) return f;
  const Symmetric<Q> posterior = inverse(around.factors);
  for (int j = 0; j < Q; ++j) f = hn::NegMulAdd(around.information[j], posterior.a[at(j, j)], f);
  return f;
}

/// The `model` covariance of ident/fit/covariance.hpp with Huber's correction K. `weighed` is the weighed_information
/// of that file.
template <int Q>
HWY_NOINLINE Symmetric<Q> model_covariance(const Settings& settings, const Start<Q>& start, const Ending& e, V f,
                                           V& weighed) {
  const V freedom = hn::Sub(start.count, f);
  const V mean_slope = hn::Div(e.slope, start.count), square = hn::Mul(mean_slope, mean_slope);
  const V slope_variance = hn::Max(hn::Sub(hn::Div(e.slope_square, start.count), square), zero());
  const V K = hn::MulAdd(hn::Div(f, start.count), hn::Div(slope_variance, square), splat(1.0));
  V variance = hn::Div(hn::Mul(hn::Mul(K, K), hn::Div(e.psi_square, freedom)), square);
  variance = hn::Max(variance, splat(settings.floor * settings.floor));
  Symmetric<Q> result;
  if (!settings.prior) {
    for (int i = 0; i < at(Q, 0); ++i) result.a[i] = hn::Mul(variance, start.unscaled.a[i]);
    return result;
  }
  const V precision = hn::IfThenElseZero(hn::Gt(e.slope, zero()), hn::Div(splat(1.0), variance));
  const V ratio = hn::Div(hn::Mul(mean_slope, variance), hn::Mul(start.sigma, start.sigma));
  weighed = hn::IfThenElse(hn::Gt(e.slope, zero()), ratio, splat(1.0));
  Symmetric<Q> information;
  for (int i = 0; i < at(Q, 0); ++i) information.a[i] = hn::Mul(precision, start.gram.a[i]);
  for (int j = 0; j < Q; ++j) {
    const V sd = splat(settings.prior_sd[j]);
    information.a[at(j, j)] = hn::Add(information.a[at(j, j)], hn::Div(splat(1.0), hn::Mul(sd, sd)));
  }
  return inverse(factor(information, information, 0.0));
}

/// The HC3 covariance of ident/fit/covariance.hpp.
template <int Q>
HWY_NOINLINE Symmetric<Q> sandwich_covariance(const View& view, const AnyLoss& loss, const Surroundings<Q>& around,
                                              V sigma, const V (&theta)[Q]) {
  Symmetric<Q> exact = zero_matrix<Q>(), weighted = zero_matrix<Q>(), meat = zero_matrix<Q>();
  for (Index i = 0; i < view.length; ++i) {
    V x[Q];
    for (int j = 0; j < Q; ++j) x[j] = row(view, view.regressors[j], i);
    const LossTerms t = loss.terms(residual(row(view, view.increments, i), x, theta));
    add_outer(t.slope, x, exact);
    add_outer(t.weight, x, weighted);
  }
  for (int j = 0; j < Q; ++j) {
    exact.a[at(j, j)] = hn::Add(exact.a[at(j, j)], around.information[j]);
    weighted.a[at(j, j)] = hn::Add(weighted.a[at(j, j)], around.information[j]);
    meat.a[at(j, j)] = hn::Mul(hn::Mul(sigma, sigma), around.information[j]);
  }
  const Ldl<Q> f = factor(exact, around.gram, 1e-14), g = factor(weighted, around.gram, 1e-14);
  Symmetric<Q> bread = inverse(f), other = inverse(g);
  for (int i = 0; i < at(Q, 0); ++i) bread.a[i] = hn::IfThenElse(f.ok, bread.a[i], other.a[i]);
  for (Index i = 0; i < view.length; ++i) {
    V x[Q];
    for (int j = 0; j < Q; ++j) x[j] = row(view, view.regressors[j], i);
    const LossTerms t = loss.terms(residual(row(view, view.increments, i), x, theta));
    const V slope = hn::IfThenElse(f.ok, t.slope, t.weight);
    const V rest = hn::NegMulAdd(slope, quadratic_form(bread, x), splat(1.0));
    const V left_out = hn::Div(t.psi, hn::Max(rest, splat(least_one_minus_leverage)));
    add_outer(hn::Mul(left_out, left_out), x, meat);
  }
  const auto entry = [](const Symmetric<Q>& m, int i, int j)
                         HWY_ATTR { return i >= j ? m.a[at(i, j)] : m.a[at(j, i)]; };
  Symmetric<Q> result;
  for (int i = 0; i < Q; ++i) {
    V half[Q];
    for (int j = 0; j < Q; ++j) {
      half[j] = zero();
      for (int k = 0; k < Q; ++k) half[j] = hn::MulAdd(entry(bread, i, k), entry(meat, k, j), half[j]);
    }
    for (int j = 0; j <= i; ++j) {
      V sum = zero();
      for (int k = 0; k < Q; ++k) sum = hn::MulAdd(half[k], entry(bread, k, j), sum);
      result.a[at(i, j)] = sum;
    }
  }
  return result;
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
