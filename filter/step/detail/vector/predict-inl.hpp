// Mixing and prediction, a mode per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_PREDICT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_PREDICT_INL
#undef MODEBANK_VECTOR_IMM_PREDICT_INL
#else
#define MODEBANK_VECTOR_IMM_PREDICT_INL
#endif

#include "filter/step/detail/vector/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// Mode by mode mu_i, mu_i d_i and mu_i (P_i + d_i d_i'), d_i about p.center: what the mixtures are sums of. They are
/// left in p.parts.
template <std::size_t N>
HWY_INLINE void prepare_mixing(const ModeRows& p, V (&center)[N]) {
  const std::size_t stride = p.stride;
  for (std::size_t a = 0; a < N; ++a) center[a] = splat(p.center[a]);
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const V mu = load(p.probability + r);
    V d[N];
    for (std::size_t a = 0; a < N; ++a) {
      d[a] = hn::Sub(load(p.mean + a * stride + r), center[a]);
      store(hn::Mul(mu, d[a]), p.parts + a * stride + r);
    }
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const std::size_t k = packed(a, b);
        const V square = hn::MulAdd(d[a], d[b], load(p.covariance + k * stride + r));
        store(hn::Mul(mu, square), p.parts + (N + k) * stride + r);
      }
  }
}

/// Means by themselves and covariances about them, for modes that differ by so much that moments about the center
/// cancel.
template <std::size_t N>
HWY_NOINLINE void mix_apart(const ModeRows& p, std::size_t r, V inverse, Moments<N>& m) {
  const std::size_t stride = p.stride;
  for (V& x : m.x) x = zero();
  for (V& P : m.P) P = zero();
  for (std::size_t i = 0; i < p.modes; ++i) {
    const V w = hn::Mul(load(p.transition + i * stride + r), splat(p.probability[i]));
    for (std::size_t a = 0; a < N; ++a) m.x[a] = hn::MulAdd(w, splat(p.mean[a * stride + i]), m.x[a]);
  }
  for (V& x : m.x) x = hn::Mul(x, inverse);
  for (std::size_t i = 0; i < p.modes; ++i) {
    const V w = hn::Mul(load(p.transition + i * stride + r), splat(p.probability[i]));
    V d[N];
    for (std::size_t a = 0; a < N; ++a) d[a] = hn::Sub(splat(p.mean[a * stride + i]), m.x[a]);
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const std::size_t k = packed(a, b);
        m.P[k] = hn::MulAdd(w, hn::MulAdd(d[a], d[b], splat(p.covariance[k * stride + i])), m.P[k]);
      }
  }
  for (V& P : m.P) P = hn::Mul(P, inverse);
}

/// Where the modes of register r start from: the mixture of all modes that lead to them (Blom & Bar-Shalom 1988).
/// `sums`: of mu_i T_ij, then of parts_i T_ij.
template <std::size_t N>
HWY_INLINE Moments<N> mixture(const ModeRows& p, std::size_t r, const V (&center)[N],
                              const V (&sums)[1 + N + packed_size(N)]) {
  const V c = sums[0];
  const M possible = hn::Ge(c, splat(impossible_probability));
  const V inverse = hn::Div(splat(1.0), hn::IfThenElse(possible, c, splat(1.0)));
  Moments<N> m;
  V shift[N];
  for (std::size_t a = 0; a < N; ++a) {
    shift[a] = hn::Mul(sums[1 + a], inverse);
    m.x[a] = hn::Add(center[a], shift[a]);
  }
  M cancelled = hn::Lt(zero(), zero());
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      const std::size_t k = packed(a, b);
      const V square = hn::Mul(sums[1 + N + k], inverse);
      m.P[k] = hn::NegMulAdd(shift[a], shift[b], square);
      if (a == b) cancelled = hn::Or(cancelled, hn::Lt(m.P[k], least_sound(square, center[a])));
    }
  if (HWY_UNLIKELY(!hn::AllFalse(D(), hn::And(possible, cancelled)))) {
    Moments<N> apart;  // not m, which can then stay in registers
    mix_apart(p, r, inverse, apart);
    m = apart;
  }
  for (std::size_t a = 0; a < N; ++a) m.x[a] = hn::IfThenElse(possible, m.x[a], load(p.mean + a * p.stride + r));
  for (std::size_t k = 0; k < packed_size(N); ++k)
    m.P[k] = hn::IfThenElse(possible, m.P[k], load(p.covariance + k * p.stride + r));
  store(c, p.predicted_probability + r);
  return m;
}

/// Keeps a prediction usable, as make_usable of kalman.hpp does.
template <std::size_t N>
HWY_INLINE void make_usable(Moments<N>& m) {
  V largest = m.P[0], least = m.P[0], mean = hn::Abs(m.x[0]);
  for (std::size_t a = 1; a < N; ++a) {
    largest = hn::Max(largest, m.P[packed(a, a)]);
    least = hn::Min(least, m.P[packed(a, a)]);
    mean = hn::Max(mean, hn::Abs(m.x[a]));
  }
  const M negative = hn::Lt(least, hn::Zero(D()));
  const M odd = hn::Or(negative, hn::Or(hn::Gt(largest, splat(largest_variance)), hn::Gt(mean, splat(largest_mean))));
  if (HWY_LIKELY(hn::AllFalse(D(), odd))) return;
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      V& P = m.P[packed(a, b)];
      P = hn::IfThenElse(negative, a == b ? hn::Abs(P) : hn::Zero(D()), P);
    }
  largest = hn::Max(largest, hn::Neg(least));
  const V shrink = hn::Div(splat(largest_variance), hn::Max(largest, splat(largest_variance)));
  for (V& P : m.P) P = hn::Mul(P, shrink);
  const V pull = hn::Div(splat(largest_mean), hn::Max(mean, splat(largest_mean)));
  for (V& x : m.x) x = hn::Mul(x, pull);
}

/// The modes of register r one step on.
template <std::size_t N>
HWY_INLINE void propagate(const ModeRows& p, std::size_t r, const double* v, V scale, const Moments<N>& from) {
  const std::size_t stride = p.stride;
  V F[N * N];
  load_rows(p.F + r, stride, F);
  Moments<N> m;
  for (std::size_t a = 0; a < N; ++a) {
    V x = load(p.c + a * stride + r);
    for (std::size_t i = 0; i < p.inputs; ++i)
      x = hn::MulAdd(load(p.B + (a * p.inputs + i) * stride + r), splat(v[i]), x);
    for (std::size_t b = 0; b < N; ++b) x = hn::MulAdd(F[a * N + b], from.x[b], x);
    m.x[a] = x;
  }
  for (std::size_t a = 0; a < N; ++a) {
    V row[N];  // of F P
    for (std::size_t b = 0; b < N; ++b) {
      row[b] = hn::Mul(F[a * N], from.P[packed(0, b)]);
      for (std::size_t k = 1; k < N; ++k) row[b] = hn::MulAdd(F[a * N + k], from.P[packed(k, b)], row[b]);
    }
    for (std::size_t b = 0; b <= a; ++b) {
      V sum = hn::Mul(scale, load(p.Q + packed(a, b) * stride + r));
      for (std::size_t k = 0; k < N; ++k) sum = hn::MulAdd(row[k], F[b * N + k], sum);
      m.P[packed(a, b)] = sum;
    }
  }
  make_usable(m);
  store_rows(m.x, stride, p.predicted_mean + r);
  store_rows(m.P, stride, p.predicted_covariance + r);
}

/// J registers of modes from r on: they share what is read of the modes they come from.
template <std::size_t N, std::size_t J>
HWY_INLINE void predict_registers(const ModeRows& p, std::size_t r, const double* v, V scale, const V (&center)[N]) {
  constexpr std::size_t parts = N + packed_size(N);
  const std::size_t stride = p.stride, L = hn::Lanes(D());
  V sums[J][1 + parts];
  for (auto& of_register : sums)
    for (V& sum : of_register) sum = zero();
  for (std::size_t i = 0; i < p.modes; ++i) {
    V T[J];
    for (std::size_t b = 0; b < J; ++b) T[b] = load(p.transition + i * stride + r + b * L);
    const V mu = splat(p.probability[i]);
    for (std::size_t b = 0; b < J; ++b) sums[b][0] = hn::MulAdd(T[b], mu, sums[b][0]);
    for (std::size_t k = 0; k < parts; ++k) {
      const V part = splat(p.parts[k * stride + i]);
      for (std::size_t b = 0; b < J; ++b) sums[b][1 + k] = hn::MulAdd(T[b], part, sums[b][1 + k]);
    }
  }
  for (std::size_t b = 0; b < J; ++b) propagate<N>(p, r + b * L, v, scale, mixture<N>(p, r + b * L, center, sums[b]));
}

template <std::size_t N>
void predict(const ModeRows& p, const double* v, double noise_scale) {
  const std::size_t L = hn::Lanes(D());
  V center[N];
  prepare_mixing<N>(p, center);
  const V scale = splat(noise_scale);
  std::size_t r = 0;
  if constexpr (N == 1)
    for (; r + 4 * L <= p.stride; r += 4 * L) predict_registers<N, 4>(p, r, v, scale, center);
  if constexpr (N <= 2)
    for (; r + 2 * L <= p.stride; r += 2 * L) predict_registers<N, 2>(p, r, v, scale, center);
  for (; r < p.stride; r += L) predict_registers<N, 1>(p, r, v, scale, center);
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
