// Many runs, a run per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_SCALAR_IMM_MANY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_SCALAR_IMM_MANY_INL
#undef MODEBANK_SCALAR_IMM_MANY_INL
#else
#define MODEBANK_SCALAR_IMM_MANY_INL
#endif

#include <array>
#include <utility>

#include "filter/scalar_imm_step-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::scalar_imm::HWY_NAMESPACE {

/// Sample k of many runs, as their modes share it.
struct LaneSample {
  V C, R, y;
  M measured;
  const double* v;
  V center;  ///< mean of all modes
};

/// The workspace, modes x lanes each.
struct LaneRows {
  double *prior, *nis, *root;  ///< before the measurement: probability; the innovation's distance and 1 / sqrt(S)
  double *first, *second;      ///< mu d and mu (P + d^2), d about the center: what the mixtures are sums of

  HWY_INLINE explicit LaneRows(const RunLanes& p) {
    const std::size_t rows = p.modes * hn::Lanes(D());
    prior = p.workspace;
    nis = prior + rows;
    root = nis + rows;
    first = root + rows;
    second = first + rows;
  }
};

/// Modes j .. j + J of every lane: where they start from.
template <std::size_t J>
struct Mixed {
  V c[J], x[J], P[J];
};

/// Means by themselves and variances about them, for modes that differ by so much that moments about the center cancel.
template <std::size_t J>
HWY_NOINLINE void mix_apart(const RunLanes& p, std::size_t j, const std::array<V, J>& inverse, Mixed<J>& m) {
  const std::size_t L = hn::Lanes(D()), K = p.modes;
  for (std::size_t b = 0; b < J; ++b) {
    m.x[b] = m.P[b] = zero();
    for (std::size_t i = 0; i < K; ++i) {
      const V w = hn::Mul(load(p.transition + (i * K + j + b) * L), load(p.probability + i * L));
      m.x[b] = hn::MulAdd(w, load(p.mean + i * L), m.x[b]);
    }
    m.x[b] = hn::Mul(m.x[b], inverse[b]);
    for (std::size_t i = 0; i < K; ++i) {
      const V w = hn::Mul(load(p.transition + (i * K + j + b) * L), load(p.probability + i * L));
      const V d = hn::Sub(load(p.mean + i * L), m.x[b]);
      m.P[b] = hn::MulAdd(w, hn::MulAdd(d, d, load(p.variance + i * L)), m.P[b]);
    }
    m.P[b] = hn::Mul(m.P[b], inverse[b]);
  }
}

/// The mixtures of all modes that lead to modes j .. j + J, which share what is loaded of the modes they come from.
template <std::size_t J>
HWY_INLINE Mixed<J> mix(const RunLanes& p, const LaneRows& rows, V center, std::size_t j) {
  const std::size_t L = hn::Lanes(D()), K = p.modes;
  Mixed<J> m;
  for (std::size_t b = 0; b < J; ++b) m.c[b] = m.x[b] = m.P[b] = zero();
  for (std::size_t i = 0; i < K; ++i) {
    const V mu = load(p.probability + i * L), first = load(rows.first + i * L), second = load(rows.second + i * L);
    for (std::size_t b = 0; b < J; ++b) {
      const V T = load(p.transition + (i * K + j + b) * L);
      m.c[b] = hn::MulAdd(T, mu, m.c[b]);
      m.x[b] = hn::MulAdd(T, first, m.x[b]);
      m.P[b] = hn::MulAdd(T, second, m.P[b]);
    }
  }
  M possible[J], cancelled = hn::Lt(zero(), zero());
  std::array<V, J> inverse;
  for (std::size_t b = 0; b < J; ++b) {
    possible[b] = hn::Ge(m.c[b], splat(impossible_probability));
    inverse[b] = reciprocal(hn::IfThenElse(possible[b], m.c[b], splat(1.0)));
    const V shift = hn::Mul(m.x[b], inverse[b]), square = hn::Mul(m.P[b], inverse[b]);
    m.x[b] = hn::Add(center, shift);
    m.P[b] = hn::NegMulAdd(shift, shift, square);
    cancelled = hn::Or(cancelled, hn::And(possible[b], hn::Lt(m.P[b], least_sound(square, center))));
  }
  if (HWY_UNLIKELY(!hn::AllFalse(D(), cancelled))) {
    Mixed<J> apart = m;  // a copy, so that m itself can stay in registers
    const std::array<V, J> weights = inverse;
    mix_apart(p, j, weights, apart);
    m = apart;
  }
  for (std::size_t b = 0; b < J; ++b) {
    m.x[b] = hn::IfThenElse(possible[b], m.x[b], load(p.mean + (j + b) * L));
    m.P[b] = hn::IfThenElse(possible[b], m.P[b], load(p.variance + (j + b) * L));
  }
  return m;
}

/// Steps modes j .. j + J of every lane. Leaves prior, distance and 1 / sqrt(S) of each in the workspace and the
/// estimates in `next`; lowers `least` to the smallest distance.
template <std::size_t J>
HWY_INLINE void step_modes(const RunLanes& p, const LaneRows& rows, const LaneSample& sample, std::size_t j,
                           double* next, V& least) {
  const std::size_t L = hn::Lanes(D()), K = p.modes;
  const Mixed<J> from = mix<J>(p, rows, sample.center, j);
  for (std::size_t b = 0; b < J; ++b) {
    const std::size_t at = (j + b) * L;
    V offset = load(p.c + at);
    for (std::size_t i = 0; i < p.inputs; ++i)
      offset = hn::MulAdd(load(p.B + (i * K + j + b) * L), load(sample.v + i * L), offset);
    const Predicted predicted(from.x[b], from.P[b], load(p.F + at), load(p.Q + at), offset);
    const V root_inverse = reciprocal_root(predicted.innovation_variance(sample.C, sample.R));
    const Step step(predicted, hn::Mul(root_inverse, root_inverse), sample.C, sample.y);
    V posterior, posterior_variance;
    step.correct(sample.C, sample.R, posterior, posterior_variance);
    store(hn::IfThenElse(sample.measured, posterior, step.mean), next + at);
    store(hn::IfThenElse(sample.measured, posterior_variance, step.variance), next + K * L + at);
    const M possible = hn::Ge(from.c[b], splat(impossible_probability));
    const V square = hn::IfThenElse(possible, step.nis(), splat(far));
    least = hn::Min(least, square);
    store(hn::IfThenElseZero(possible, from.c[b]), rows.prior + at);
    store(square, rows.nis + at);
    store(root_inverse, rows.root + at);
  }
}

/// What the next step mixes, of the present means, variances and unnormalised probabilities; returns the center.
HWY_INLINE V prepare_mixing(const RunLanes& p, const LaneRows& rows, V total) {
  const std::size_t L = hn::Lanes(D()), K = p.modes;
  const V normal = reciprocal(total);
  V center = zero();
  for (std::size_t j = 0; j < K; ++j) {
    const V mu = hn::Mul(load(p.probability + j * L), normal);
    store(mu, p.probability + j * L);
    center = hn::MulAdd(mu, load(p.mean + j * L), center);
  }
  for (std::size_t j = 0; j < K; ++j) {
    const V mu = load(p.probability + j * L), d = hn::Sub(load(p.mean + j * L), center);
    store(hn::Mul(mu, d), rows.first + j * L);
    store(hn::Mul(mu, hn::MulAdd(d, d, load(p.variance + j * L))), rows.second + j * L);
  }
  return center;
}

/// As many runs as there are lanes. Means and variances are in `p.mean` and `p.next` in turn.
void many_runs(const RunLanes& p) {
  const std::size_t L = hn::Lanes(D()), K = p.modes;
  const LaneRows rows(p);
  const Exp exp;
  RunLanes now = p;
  double* next = p.next;
  V result = zero(), center = prepare_mixing(now, rows, splat(1.0));
  for (std::size_t k = 1; k < p.count; ++k) {
    const V y_or_nan = load(p.measurement + k * L);
    const M measured = hn::Lt(hn::Abs(y_or_nan), splat(largest_measurement));
    const LaneSample sample{
        load(p.C), load(p.R), hn::IfThenElseZero(measured, y_or_nan), measured, p.v + (k - 1) * p.inputs * L, center};
    V least = splat(far);
    std::size_t j = 0;
    for (; K - j >= 4 && K - j != 5; j += 4) step_modes<4>(now, rows, sample, j, next, least);
    for (; K - j >= 3; j += 3) step_modes<3>(now, rows, sample, j, next, least);
    if (K - j == 2) step_modes<2>(now, rows, sample, j, next, least);
    if (K - j == 1) step_modes<1>(now, rows, sample, j, next, least);
    V sum = zero();
    for (j = 0; j < K; ++j) {
      const V c = load(rows.prior + j * L);
      const V w = hn::IfThenElse(measured, weight(exp, c, load(rows.nis + j * L), least, load(rows.root + j * L)), c);
      store(w, rows.prior + j * L);
      sum = hn::Add(sum, w);
    }
    const V log_density = hn::Sub(hn::Log(D(), sum), hn::Mul(splat(0.5), hn::Add(splat(log_two_pi), least)));
    result = hn::Add(result, hn::IfThenElseZero(measured, log_density));
    const V scale = reciprocal(sum);
    V total = zero();
    for (j = 0; j < K; ++j) {
      const V mu = hn::Max(hn::Mul(load(rows.prior + j * L), scale), splat(mode_probability_floor));
      store(mu, p.probability + j * L);
      total = hn::Add(total, mu);
    }
    std::swap(now.mean, next);
    now.variance = now.mean + K * L;
    center = prepare_mixing(now, rows, total);
  }
  store(result, p.log_likelihood);
}

}  // namespace modebank::scalar_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
