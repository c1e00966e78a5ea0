// Fits one vector of consecutive windows, one window per lane, from samples to LocalModel.
#if defined(MODEBANK_BATCH_KERNEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_KERNEL_INL
#undef MODEBANK_BATCH_KERNEL_INL
#else
#define MODEBANK_BATCH_KERNEL_INL
#endif

#include <hwy/highway.h>

#include <type_traits>

#include "ident/fit/detail/batch/ending-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The numbers of a LocalModel, one vector per number.
template <int Q>
struct Fit {
  Search<Q> search;
  Symmetric<Q> covariance;
  V noise_variance, condition, rank, inlier_fraction, r_squared, weighed_information, samples;
  V information[Q];
  M clear, enough, reached, deficient;
};

/// R^2, as defined in ident/fit/describe.hpp.
HWY_INLINE V r_squared(const Ending& e) {
  const V nan = splat(std::numeric_limits<double>::quiet_NaN());
  const V total = hn::NegMulAdd(e.omega_y, hn::Div(e.omega_y, e.omega), e.omega_y_square);
  return hn::IfThenElse(hn::Gt(total, zero()), hn::Sub(splat(1.0), hn::Div(e.weighted_square, total)), nan);
}

HWY_INLINE M finite(V x) { return hn::Lt(hn::Abs(x), splat(std::numeric_limits<double>::infinity())); }

template <int Q, class LossT>
HWY_INLINE void describe(const Settings& settings, const View& view, const LossT& loss, const Start<Q>& start,
                         const Surroundings<Q>& around, Fit<Q>& fit) {
  const Ending e = residual_sums(view, loss, fit.search.theta);
  const V f = data_parameters(settings, around);
  fit.weighed_information = splat(std::numeric_limits<double>::quiet_NaN());
  if (settings.covariance == CovarianceKind::sandwich) {
    const AnyLoss any_loss(settings.loss, hn::Mul(splat(settings.loss_scale), start.sigma));
    fit.covariance = sandwich_covariance(view, any_loss, around, start.sigma, fit.search.theta);
  } else {
    fit.covariance = model_covariance(settings, start, e, f, fit.weighed_information);
  }
  const V divisor = hn::Mul(hn::Sub(start.count, start.rank), splat(settings.consistency));
  fit.noise_variance = hn::Max(hn::Div(e.weighted_square, divisor), splat(settings.floor * settings.floor));
  fit.inlier_fraction = hn::Div(e.inliers, start.count);
  fit.r_squared = r_squared(e);
  for (int j = 0; j < Q; ++j) {
    const V sd = splat(settings.prior ? settings.prior_sd[j] : std::numeric_limits<double>::quiet_NaN());
    fit.information[j] = hn::Sub(splat(1.0), hn::Div(fit.covariance.a[at(j, j)], hn::Mul(sd, sd)));
  }
  // if the slope is not positive, the data contain no information about theta
  if (!settings.prior) fit.reached = hn::And(fit.reached, hn::Gt(e.slope, zero()));
}

/// X'X + sigma^2 P and the posterior least-squares solution, the start of the search.
template <int Q>
HWY_NOINLINE Surroundings<Q> surround(const Settings& settings, Start<Q>& start) {
  Surroundings<Q> around{start.gram, {}, {}, start.square_sum, settings.max_iterations, {}};
  V moment[Q];
  for (int i = 0; i < Q; ++i) {
    around.information[i] = around.mean[i] = zero();
    if (!settings.prior) continue;
    const V share = hn::Div(start.sigma, splat(settings.prior_sd[i]));
    around.information[i] = hn::Mul(share, share);
    around.mean[i] = splat(settings.prior_mean[i]);
    around.gram.a[at(i, i)] = hn::Add(around.gram.a[at(i, i)], around.information[i]);
  }
  around.factors = factor(around.gram, around.gram, least_weight);
  if (!settings.prior) return around;
  for (int i = 0; i < Q; ++i) moment[i] = hn::MulAdd(around.information[i], around.mean[i], start.moment[i]);
  solve(around.factors, moment, start.theta);
  start.clear = hn::And(start.clear, around.factors.ok);
  return around;
}

template <class LossT>
HWY_INLINE LossT make_loss(Loss kind, V scale) {
  if constexpr (std::is_constructible_v<LossT, Loss, V>) {
    return LossT(kind, scale);
  } else {
    return LossT(scale);
  }
}

/// A lane counts as converged only if its result is finite.
template <int Q>
HWY_INLINE void require_finite(Fit<Q>& fit) {
  for (int j = 0; j < Q; ++j) fit.reached = hn::And(fit.reached, finite(fit.search.theta[j]));
  for (int j = 0; j < Q; ++j) fit.reached = hn::And(fit.reached, finite(fit.covariance.a[at(j, j)]));
}

template <int Q, class LossT, class FirstLoss>
HWY_INLINE void fit_group(const Settings& settings, const View& view, M wanted, double* scratch, Fit<Q>& fit) {
  Start<Q> start = prepare<Q>(settings, view, wanted, scratch);
  const Surroundings<Q> around = surround(settings, start);
  for (int j = 0; j < Q; ++j) fit.search.theta[j] = start.theta[j];
  fit.enough = hn::Gt(start.count, splat(Q));
  fit.clear = start.clear;
  fit.deficient = start.deficient;
  fit.condition = start.condition;
  fit.rank = start.rank;
  fit.samples = start.count;
  M live = hn::And(hn::And(wanted, fit.enough), fit.clear);
  if (!settings.prior) live = hn::AndNot(fit.deficient, live);
  const LossT loss = make_loss<LossT>(settings.loss, hn::Mul(splat(settings.loss_scale), start.sigma));
  if (settings.loss != Loss::trivial && settings.loss != Loss::huber && settings.loss != Loss::softlone) {
    const FirstLoss first = make_loss<FirstLoss>(Loss::huber, hn::Mul(splat(settings.huber_scale), start.sigma));
    minimise(view, first, around, live, fit.search);
  }
  fit.reached = minimise(view, loss, around, live, fit.search);
  describe(settings, view, loss, start, around, fit);
  require_finite(fit);
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
