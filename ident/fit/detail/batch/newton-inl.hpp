// Minimises one window per lane.
#if defined(MODEBANK_BATCH_NEWTON_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_NEWTON_INL
#undef MODEBANK_BATCH_NEWTON_INL
#else
#define MODEBANK_BATCH_NEWTON_INL
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "ident/fit/detail/batch/window-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The search ends if the expected gain of a Newton step, g' H^-1 g, is at most this share of sum psi^2. H is at most
/// X'X + P, so the gradient in orthonormal coordinates is then at most sqrt(share) |psi|.
inline constexpr double stationary_square = stationary_gradient * stationary_gradient;
/// Gains below this share of sum y^2 are rounding errors.
inline constexpr double rounding_square = 1e-30;
/// Newton steps need a second derivative whose pivots are above this share of the pivots of the regressors' Gram
/// matrix.
inline constexpr double least_curvature = 1e-8;
/// Reweighted steps need a Gram matrix whose pivots exceed this share.
inline constexpr double least_weight = 1e-12;
/// If a second derivative is too weak, this share of the regressors' own second derivative is added. Steps are then
/// long in directions in which all samples are outliers. Steps that are too long are halved.
inline constexpr double curvature_share = 0.01;
/// Largest relative increase of the objective that counts as rounding.
inline constexpr double cost_rounding = 1e-12;
inline constexpr int max_halvings = 40;

/// Inputs of a search, in addition to samples and loss.
template <int Q>
struct Surroundings {
  Symmetric<Q> gram;  // X'X + P, the second derivative if every sample keeps full weight
  V information[Q];   // P, diagonal, in units of sigma^2 / parameter^2; 0 without a prior
  V mean[Q];
  V square_sum;  // sum y^2
  int max_iterations;
  Ldl<Q> factors;  // LDL factors of `gram`
};

/// State of a search.
template <int Q>
struct Search {
  V theta[Q];
};

/// The prior's cost sum_j P_j (theta_j - mean_j)^2. Adds its gradient, too.
template <int Q>
HWY_INLINE V add_prior(const Surroundings<Q>& around, const V (&theta)[Q], Sums<Q>& s) {
  V square = zero();
  for (int j = 0; j < Q; ++j) {
    const V away = hn::Sub(around.mean[j], theta[j]), pull = hn::Mul(around.information[j], away);
    s.gradient[j] = hn::Add(s.gradient[j], pull);
    s.hessian.a[at(j, j)] = hn::Add(s.hessian.a[at(j, j)], around.information[j]);
    square = hn::MulAdd(pull, away, square);
  }
  s.cost = hn::Add(s.cost, square);
  return square;
}

/// sum y^2 + sum_j theta_j^2 (X'X)_jj: the size of the terms that cancel in the residuals.
template <int Q>
HWY_INLINE V magnitude(const Symmetric<Q>& gram, V square_sum, const V (&theta)[Q]) {
  V sum = square_sum;
  for (int j = 0; j < Q; ++j) sum = hn::MulAdd(hn::Mul(theta[j], theta[j]), gram.a[at(j, j)], sum);
  return sum;
}

/// A step for the lanes in `weak`, whose second derivative is not safely positive. A share of the regressors' own
/// second derivative is added first. If the sum is still not positive, takes a step of reweighted least squares, which
/// cannot increase the loss. Returns the lanes that have a step.
template <int Q, class LossT>
HWY_NOINLINE M cautious_step(const View& view, const LossT& loss, const Surroundings<Q>& around, const V (&theta)[Q],
                             const Sums<Q>& s, M weak, V (&step)[Q]) {
  V other[Q];
  Symmetric<Q> damped;
  for (int i = 0; i < at(Q, 0); ++i) damped.a[i] = hn::MulAdd(splat(curvature_share), around.gram.a[i], s.hessian.a[i]);
  const Ldl<Q> f = factor(damped, around.gram, least_curvature);
  solve(f, s.gradient, other);
  const M strong = hn::And(weak, f.ok);
  for (int j = 0; j < Q; ++j) step[j] = hn::IfThenElse(strong, other[j], step[j]);
  weak = hn::AndNot(strong, weak);
  if (!any(weak)) return strong;
  Symmetric<Q> weighted = reweighted_gram(view, loss, theta);
  for (int j = 0; j < Q; ++j) weighted.a[at(j, j)] = hn::Add(weighted.a[at(j, j)], around.information[j]);
  const Ldl<Q> g = factor(weighted, around.gram, least_weight);
  solve(g, s.gradient, other);
  for (int j = 0; j < Q; ++j) step[j] = hn::IfThenElse(weak, other[j], step[j]);
  return hn::Or(strong, hn::And(weak, g.ok));
}

/// The Newton step of the lanes in `wanted`. Returns the lanes that have a step.
template <int Q, class LossT>
HWY_INLINE M next_step(const View& view, const LossT& loss, const Surroundings<Q>& around, const V (&theta)[Q],
                       const Sums<Q>& s, M wanted, V (&step)[Q]) {
  if constexpr (LossT::quadratic) {
    solve(around.factors, s.gradient, step);
    return around.factors.ok;
  } else {
    const Ldl<Q> f = factor(s.hessian, around.gram, least_curvature);
    solve(f, s.gradient, step);
    const M weak = hn::AndNot(f.ok, wanted);
    if (!any(weak)) return f.ok;
    return hn::Or(f.ok, cautious_step(view, loss, around, theta, s, weak, step));
  }
}

/// Newton's method with the exact second derivative, from search.theta. Steps are halved until the objective does not
/// increase. Returns the lanes of `live` that reached a stationary point.
template <int Q, class LossT>
HWY_NOINLINE M minimise(const View& view, const LossT& loss, const Surroundings<Q>& around, M live, Search<Q>& search) {
  V(&theta)[Q] = search.theta;
  M reached = none();
  V best[Q], step[Q], best_cost = splat(std::numeric_limits<double>::infinity()), halvings = zero();
  for (int j = 0; j < Q; ++j) best[j] = theta[j], step[j] = zero();
  for (int iteration = 0; any(live) && iteration < around.max_iterations + max_halvings; ++iteration) {
    Sums<Q> s = evaluate(view, loss, theta);
    const V prior_square = add_prior(around, theta, s);
    const V allowed = hn::MulAdd(splat(cost_rounding), hn::Abs(best_cost), best_cost);
    const M worse = hn::And(live, hn::Gt(s.cost, allowed)), accepted = hn::AndNot(worse, live);
    for (int j = 0; j < Q; ++j) best[j] = hn::IfThenElse(accepted, theta[j], best[j]);
    best_cost = hn::IfThenElse(accepted, s.cost, best_cost);

    V newton[Q];
    const M usable = next_step(view, loss, around, theta, s, accepted, newton);
    const V gain = dot(newton, s.gradient), scale = hn::Add(s.psi_square, prior_square);
    const V enough = hn::Max(hn::Mul(splat(stationary_square), scale),
                             hn::Mul(splat(rounding_square), magnitude(around.gram, around.square_sum, theta)));
    const M done = hn::And(hn::And(accepted, usable), hn::Le(gain, enough));

    halvings = hn::IfThenElse(worse, hn::Add(halvings, splat(1.0)), zero());
    for (int j = 0; j < Q; ++j) {
      step[j] = hn::IfThenElse(worse, hn::Mul(splat(0.5), step[j]), newton[j]);
      theta[j] = hn::IfThenElse(live, hn::Add(best[j], step[j]), theta[j]);
    }
    reached = hn::Or(reached, done);
    const M lost = hn::Or(hn::Gt(halvings, splat(max_halvings)), hn::AndNot(usable, accepted));
    live = hn::AndNot(hn::Or(done, lost), live);
  }
  return reached;
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
