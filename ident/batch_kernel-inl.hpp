// The fit of as many consecutive windows as a vector has lanes, from samples to LocalModel, and the loop over a chunk.
#if defined(MODEBANK_BATCH_KERNEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_KERNEL_INL
#undef MODEBANK_BATCH_KERNEL_INL
#else
#define MODEBANK_BATCH_KERNEL_INL
#endif

#include <hwy/highway.h>

#include <type_traits>

#include "ident/batch_newton-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Normal equations with pivots below this share of the diagonal lose more than half of their digits.
inline constexpr double least_pivot = 1e-8;
/// A regressor that is this small a share of itself, once the ones before it are taken out, depends on them.
inline constexpr double dependent = 1e-9;
/// Singular values between `dependent` and this share of the largest are left to the singular value decomposition of
/// the slow path: the rank's tolerance, 1e-6, lies between.
inline constexpr double clearly_independent = 1e-5;
inline constexpr double rank_tolerance = 1e-6;
inline constexpr double least_one_minus_leverage = 1e-6;
inline constexpr double inlier_weight = 0.5;

/// Samples, least squares and scale of the windows, before any loss.
template <int Q>
struct Start {
  Symmetric<Q> gram;      // X'X
  Symmetric<Q> unscaled;  // (X'X)^-1; meaningless where the rank is deficient
  Ldl<Q> factors;         // of X'X, of the bare path
  V moment[Q];            // X'y
  V theta[Q];             // least squares; meaningless where the rank is deficient
  V square_sum, count, rank, condition, sigma;
  M clear;      // the rank is beyond doubt
  M deficient;  // of those
};

/// Columns of regressors and increments made orthogonal one after the other (modified Gram-Schmidt with the increments
/// as last column, backward stable: Bjorck 1967); leaves least-squares residuals in the last column.
template <int Q>
struct Orthogonal {
  V r[Q][Q];  // column j of the triangle: r[j][0..j]
  V z[Q];     // Q' y
  V norm[Q];  // of the regressors
  M kept[Q];
};

template <int Q>
HWY_NOINLINE Orthogonal<Q> orthogonalise(const View& view, double* scratch) {
  const D d;
  const Index lanes = static_cast<Index>(hn::Lanes(d)), stride = lanes * (Q + 1);
  Orthogonal<Q> o;
  V square[Q];
  for (V& entry : square) entry = zero();
  for (Index i = 0; i < view.length; ++i) {
    for (int j = 0; j < Q; ++j) {
      const V x = row(view, view.regressors[j], i);
      square[j] = hn::MulAdd(x, x, square[j]);
      hn::Store(x, d, scratch + i * stride + j * lanes);
    }
    hn::Store(row(view, view.increments, i), d, scratch + i * stride + Q * lanes);
  }
  for (int j = 0; j < Q; ++j) o.norm[j] = hn::Sqrt(square[j]);
  for (int j = 0; j < Q; ++j) {
    for (int k = 0; k < Q; ++k) o.r[j][k] = k < j ? o.r[j][k] : zero();
    const V length = hn::Sqrt(square[j]);
    o.kept[j] = hn::Gt(length, hn::Mul(splat(dependent), o.norm[j]));
    o.r[j][j] = length;
    const V inverse = hn::IfThenElseZero(o.kept[j], hn::Div(splat(1.0), length));
    V product[Q + 1];
    for (V& entry : product) entry = zero();
    for (Index i = 0; i < view.length; ++i) {
      double* const at_i = scratch + i * stride;
      const V q = hn::Mul(hn::Load(d, at_i + j * lanes), inverse);
      hn::Store(q, d, at_i + j * lanes);
      for (int k = j + 1; k <= Q; ++k) product[k] = hn::MulAdd(q, hn::Load(d, at_i + k * lanes), product[k]);
    }
    for (int k = j + 1; k < Q; ++k) o.r[k][j] = product[k];
    o.z[j] = product[Q];
    V next = zero();
    for (Index i = 0; i < view.length; ++i) {
      double* const at_i = scratch + i * stride;
      const V q = hn::Load(d, at_i + j * lanes);
      for (int k = j + 1; k <= Q; ++k) {
        const V rest = hn::NegMulAdd(product[k], q, hn::Load(d, at_i + k * lanes));
        hn::Store(rest, d, at_i + k * lanes);
        if (k == j + 1) next = hn::MulAdd(rest, rest, next);
      }
    }
    if (j + 1 < Q) square[j + 1] = next;
  }
  return o;
}

/// Rank and condition from the triangle with its columns scaled to the regressors' unit norm.
template <int Q>
HWY_INLINE void judge_rank(const Orthogonal<Q>& o, Start<Q>& start) {
  V column[Q][Q], sigma[Q];
  for (int j = 0; j < Q; ++j) {
    const V scale = hn::IfThenElse(hn::Gt(o.norm[j], zero()), hn::Div(splat(1.0), o.norm[j]), splat(1.0));
    for (int k = 0; k < Q; ++k) column[j][k] = k <= j ? hn::Mul(o.r[j][k], scale) : zero();
  }
  singular_values(column, sigma);
  V least = sigma[0], largest = sigma[0], kept = zero();
  for (int j = 1; j < Q; ++j) {
    least = hn::Min(least, sigma[j]);
    largest = hn::Max(largest, sigma[j]);
  }
  start.condition =
      hn::IfThenElse(hn::Gt(least, zero()), hn::Div(largest, least), splat(std::numeric_limits<double>::infinity()));
  start.rank = zero();
  start.clear = hn::Eq(zero(), zero());
  for (int j = 0; j < Q; ++j) {
    kept = hn::Add(kept, hn::IfThenElseZero(o.kept[j], splat(1.0)));
    start.rank =
        hn::Add(start.rank, hn::IfThenElseZero(hn::Gt(sigma[j], hn::Mul(splat(rank_tolerance), largest)), splat(1.0)));
    const M doubtful = hn::And(hn::Gt(sigma[j], hn::Mul(splat(dependent), largest)),
                               hn::Lt(sigma[j], hn::Mul(splat(clearly_independent), largest)));
    start.clear = hn::AndNot(doubtful, start.clear);
  }
  start.clear = hn::And(start.clear, hn::Eq(kept, start.rank));
  start.deficient = hn::Lt(start.rank, splat(Q));
}

/// theta = R^-1 z, X'X = R'R and its inverse R^-1 R^-T.
template <int Q>
HWY_INLINE void solve_triangle(const Orthogonal<Q>& o, Start<Q>& start) {
  V r[Q][Q];  // without the rows of dependent columns, which hold rounding errors
  for (int j = 0; j < Q; ++j)
    for (int k = 0; k <= j; ++k) r[j][k] = hn::IfThenElseZero(o.kept[k], o.r[j][k]);
  for (int i = 0; i < Q; ++i)
    for (int j = 0; j <= i; ++j) {
      V sum = hn::Mul(r[i][0], r[j][0]);
      for (int k = 1; k <= j; ++k) sum = hn::MulAdd(r[i][k], r[j][k], sum);
      start.gram.a[at(i, j)] = sum;
    }
  V inverse[Q][Q];  // column j of R^-1
  for (int j = 0; j < Q; ++j)
    for (int i = j; i >= 0; --i) {
      V sum = i == j ? splat(1.0) : zero();
      for (int k = i + 1; k <= j; ++k) sum = hn::NegMulAdd(r[k][i], inverse[j][k], sum);
      inverse[j][i] = hn::Div(sum, r[i][i]);
    }
  for (int i = 0; i < Q; ++i) {
    V sum = hn::Mul(inverse[i][i], o.z[i]);
    for (int k = i + 1; k < Q; ++k) sum = hn::MulAdd(inverse[k][i], o.z[k], sum);
    start.theta[i] = sum;
    start.moment[i] = hn::Mul(r[i][0], o.z[0]);
    for (int k = 1; k <= i; ++k) start.moment[i] = hn::MulAdd(r[i][k], o.z[k], start.moment[i]);
    for (int j = 0; j <= i; ++j) {
      V entry = zero();
      for (int k = i; k < Q; ++k) entry = hn::MulAdd(inverse[k][i], inverse[k][j], entry);
      start.unscaled.a[at(i, j)] = entry;
    }
  }
}

HWY_INLINE V sample_count(const View& view) {
  if (!view.present) return splat(static_cast<double>(view.length));
  V count = zero();
  for (Index i = 0; i < view.length; ++i) count = hn::Add(count, row(view, view.present, i));
  return count;
}

template <int Q>
HWY_NOINLINE Start<Q> prepare(const Settings& settings, const View& view, double sigma, double* scratch) {
  const D d;
  const Index lanes = static_cast<Index>(hn::Lanes(d));
  Start<Q> start;
  start.count = sample_count(view);
  const Orthogonal<Q> o = orthogonalise<Q>(view, scratch);
  judge_rank(o, start);
  solve_triangle(o, start);
  start.square_sum = zero();
  for (Index i = 0; i < view.length; ++i) {
    const V y = row(view, view.increments, i);
    start.square_sum = hn::MulAdd(y, y, start.square_sum);
  }
  start.sigma = splat(sigma);
  if (!settings.own_scale) return start;
  double* const rows = scratch + view.length * lanes * (Q + 1);
  for (Index i = 0; i < view.length; ++i)
    hn::Store(hn::Load(d, scratch + (i * (Q + 1) + Q) * lanes), d, rows + i * lanes);
  const V mad = normalised_mad(settings, view, rows, start.count);
  const V factor = hn::Sqrt(hn::Div(start.count, hn::Sub(start.count, start.rank)));
  start.sigma = hn::Max(hn::Mul(mad, factor), splat(settings.floor));
  return start;
}

/// Without rank verdict and scale: normal equations, trusted where their pivots are.
template <int Q>
HWY_NOINLINE Start<Q> prepare_bare(const View& view, double sigma) {
  Start<Q> start;
  const NormalEquations<Q> n = normal_equations<Q>(view);
  const Ldl<Q> f = factor(n.gram, n.gram, least_pivot);
  start.gram = n.gram;
  start.square_sum = n.square_sum;
  start.sigma = splat(sigma);
  start.count = sample_count(view);
  start.rank = splat(Q);
  start.clear = f.ok;
  start.deficient = none();
  for (int j = 0; j < Q; ++j) start.moment[j] = n.moment[j];
  start.condition = zero();
  solve(f, n.moment, start.theta);
  start.unscaled = inverse(f);
  start.factors = f;
  return start;
}

/// What the residuals at the optimum say. omega = rho' is a sample's robust weight, y its increment.
struct Ending {
  V psi_square, slope, slope_square, weighted_square, inliers;
  V omega, omega_y, omega_y_square;  // y about the window's first increment
  V cost;                            // sum rho, 0 for residuals of 0
};

/// A row where no transition is counts nothing: its residual of zero has rho = 0, slope and omega 1.
template <int Q, class LossT>
HWY_NOINLINE Ending residual_sums(const View& view, const LossT& loss, const V (&theta)[Q]) {
  Ending e{zero(), zero(), zero(), zero(), zero(), zero(), zero(), zero(), zero()};
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
    e.cost = hn::Add(e.cost, cost_above_zero(loss, r, t));
  }
  return e;
}

/// Of the bare path, whose sums the search has: absent transitions stand there as residuals of zero.
template <int Q>
HWY_INLINE Ending sums_of_search(const View& view, const Search<Q>& search, V count) {
  const V absent = hn::Sub(splat(static_cast<double>(view.length)), count);
  return {search.psi_square,
          hn::Sub(search.slope, absent),
          hn::Sub(search.slope_square, absent),
          zero(),
          zero(),
          zero(),
          zero(),
          zero(),
          zero()};
}

/// Parameters that the data determine, the sum of the samples' leverages at sigma.
template <int Q>
HWY_INLINE V data_parameters(const Settings& settings, const Surroundings<Q>& around) {
  V f = splat(Q);
  if (!settings.prior) return f;
  const Symmetric<Q> posterior = inverse(around.factors);
  for (int j = 0; j < Q; ++j) f = hn::NegMulAdd(around.information[j], posterior.a[at(j, j)], f);
  return f;
}

/// As ident/covariance.hpp states it, with Huber's correction K.
template <int Q>
HWY_NOINLINE Symmetric<Q> model_covariance(const Settings& settings, const Start<Q>& start, const Ending& e, V f) {
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
  Symmetric<Q> information;
  for (int i = 0; i < at(Q, 0); ++i) information.a[i] = hn::Mul(precision, start.gram.a[i]);
  for (int j = 0; j < Q; ++j) {
    const V sd = splat(settings.prior_sd[j]);
    information.a[at(j, j)] = hn::Add(information.a[at(j, j)], hn::Div(splat(1.0), hn::Mul(sd, sd)));
  }
  return inverse(factor(information, information, 0.0));
}

/// HC3 as ident/covariance.hpp states it.
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

/// One vector per number of a LocalModel.
template <int Q>
struct Fit {
  Search<Q> search;
  Symmetric<Q> covariance;
  V noise_variance, condition, rank, inlier_fraction, r_squared;
  V samples, sigma, deviance, data_parameters, price;  // what Akaike's criterion is made from
  V information[Q];
  M clear, enough, reached, deficient;
};

/// R^2 and the parts of AIC as ident/fit_quality.hpp states them.
template <int Q>
HWY_INLINE void describe_quality(const Settings& settings, const Ending& e, V f, V sigma, Fit<Q>& fit) {
  const V nan = splat(std::numeric_limits<double>::quiet_NaN());
  const V total = hn::NegMulAdd(e.omega_y, hn::Div(e.omega_y, e.omega), e.omega_y_square);
  fit.r_squared = hn::IfThenElse(hn::Gt(total, zero()), hn::Sub(splat(1.0), hn::Div(e.weighted_square, total)), nan);
  fit.sigma = sigma;
  fit.data_parameters = f;
  fit.deviance = settings.loss == Loss::trivial ? e.weighted_square : e.cost;
  fit.price =
      hn::IfThenElse(hn::Gt(e.slope, zero()), hn::Div(hn::Div(e.psi_square, hn::Mul(sigma, sigma)), e.slope), nan);
}

HWY_INLINE M finite(V x) { return hn::Lt(hn::Abs(x), splat(std::numeric_limits<double>::infinity())); }

template <int Q, class LossT>
HWY_INLINE void describe(const Settings& settings, const View& view, const LossT& loss, const Start<Q>& start,
                         const Surroundings<Q>& around, Fit<Q>& fit) {
  const Ending e =
      settings.bare ? sums_of_search(view, fit.search, start.count) : residual_sums(view, loss, fit.search.theta);
  const V f = data_parameters(settings, around);
  const bool sandwich = settings.covariance == CovarianceKind::sandwich && !settings.bare;
  if (sandwich) {
    const AnyLoss any_loss(settings.loss, hn::Mul(splat(settings.loss_scale), start.sigma));
    fit.covariance = sandwich_covariance(view, any_loss, around, start.sigma, fit.search.theta);
  } else {
    fit.covariance = model_covariance(settings, start, e, f);
  }
  if (settings.bare) return;
  const V divisor = hn::Mul(hn::Sub(start.count, start.rank), splat(settings.consistency));
  fit.noise_variance = hn::Max(hn::Div(e.weighted_square, divisor), splat(settings.floor * settings.floor));
  fit.inlier_fraction = hn::Div(e.inliers, start.count);
  describe_quality(settings, e, f, start.sigma, fit);
  for (int j = 0; j < Q; ++j) {
    const V sd = splat(settings.prior ? settings.prior_sd[j] : std::numeric_limits<double>::quiet_NaN());
    fit.information[j] = hn::Sub(splat(1.0), hn::Div(fit.covariance.a[at(j, j)], hn::Mul(sd, sd)));
  }
  if (!settings.prior) fit.reached = hn::And(fit.reached, hn::Gt(e.slope, zero()));  // else nothing is known of theta
}

/// X'X + sigma^2 P and the posterior least-squares solution, from which the search starts.
template <int Q>
HWY_NOINLINE Surroundings<Q> surround(const Settings& settings, Start<Q>& start) {
  Surroundings<Q> around{start.gram, {}, {}, start.square_sum, settings.max_iterations, start.factors};
  V moment[Q];
  for (int i = 0; i < Q; ++i) {
    around.information[i] = around.mean[i] = zero();
    if (!settings.prior) continue;
    const V share = hn::Div(start.sigma, splat(settings.prior_sd[i]));
    around.information[i] = hn::Mul(share, share);
    around.mean[i] = splat(settings.prior_mean[i]);
    around.gram.a[at(i, i)] = hn::Add(around.gram.a[at(i, i)], around.information[i]);
  }
  if (!settings.bare) around.factors = factor(around.gram, around.gram, least_weight);
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

template <int Q, class LossT, class FirstLoss>
HWY_INLINE void fit_group(const Settings& settings, const View& view, M wanted, double sigma, double* scratch,
                          Fit<Q>& fit) {
  Start<Q> start = settings.bare ? prepare_bare<Q>(view, sigma) : prepare<Q>(settings, view, sigma, scratch);
  const Surroundings<Q> around = surround(settings, start);
  for (int j = 0; j < Q; ++j) fit.search.theta[j] = start.theta[j];
  fit.enough = hn::Gt(start.count, splat(Q));
  fit.clear = start.clear;
  fit.deficient = start.deficient;
  fit.condition = start.condition;
  fit.rank = start.rank;
  fit.samples = start.count;
  fit.search.gradient = fit.search.psi_square = fit.search.slope = fit.search.slope_square = zero();
  M live = hn::And(hn::And(wanted, fit.enough), fit.clear);
  if (!settings.prior) live = hn::AndNot(fit.deficient, live);
  const LossT loss = make_loss<LossT>(settings.loss, hn::Mul(splat(settings.loss_scale), start.sigma));
  if (settings.loss != Loss::trivial && settings.loss != Loss::huber && settings.loss != Loss::softlone) {
    const FirstLoss first = make_loss<FirstLoss>(Loss::huber, hn::Mul(splat(settings.huber_scale), start.sigma));
    minimise(view, first, around, live, fit.search);
  }
  fit.reached = minimise(view, loss, around, live, fit.search);
  describe(settings, view, loss, start, around, fit);
  for (int j = 0; j < Q; ++j) fit.reached = hn::And(fit.reached, finite(fit.search.theta[j]));
  for (int j = 0; j < Q; ++j) fit.reached = hn::And(fit.reached, finite(fit.covariance.a[at(j, j)]));
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
