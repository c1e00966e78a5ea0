// Prediction, one mode per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_PREDICT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_PREDICT_INL
#undef MODEBANK_VECTOR_IMM_PREDICT_INL
#else
#define MODEBANK_VECTOR_IMM_PREDICT_INL
#endif

#include "filter/step/detail/vector/expect-inl.hpp"
#include "filter/step/detail/vector/mixing-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// Repairs a prediction, like make_usable of kalman.hpp.
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

/// Advances the modes of register r by one step.
template <std::size_t N>
HWY_INLINE Moments<N> propagate(const ModeRows& p, std::size_t r, const double* v, V scale, const Moments<N>& from) {
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
    V row[N];  // row of F P
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
  return m;
}

/// Processes J registers of modes from r on together. These registers share the loads of the previous modes.
template <std::size_t N, std::size_t NY, std::size_t J>
HWY_INLINE void predict_registers(const ModeRows& p, const Sensor& sensor, std::size_t r, const double* v, V scale,
                                  Prediction<N, NY> (&q)[J]) {
  constexpr std::size_t parts = N + packed_size(N);
  const std::size_t stride = p.stride, L = hn::Lanes(D());
  V sums[J][1 + parts];
  for (auto& of_register : sums)
    for (V& sum : of_register) sum = zero();
  for (std::size_t i = 0; i < p.modes; ++i) {  // a separate loop, because all other results are divided by this one
    const V mu = splat(p.probability[i]);
    for (std::size_t b = 0; b < J; ++b)
      sums[b][0] = hn::MulAdd(load(p.transition + i * stride + r + b * L), mu, sums[b][0]);
  }
  for (std::size_t i = 0; i < p.modes; ++i) {
    V T[J];
    for (std::size_t b = 0; b < J; ++b) T[b] = in_register(load(p.transition + i * stride + r + b * L));
    for (std::size_t k = 0; k < parts; ++k) {
      const V part = splat(p.parts[k * stride + i]);
      for (std::size_t b = 0; b < J; ++b) sums[b][1 + k] = hn::MulAdd(T[b], part, sums[b][1 + k]);
    }
  }
#pragma GCC unroll 4
  for (std::size_t b = 0; b < J; ++b) {
    const std::size_t at = r + b * L;
    q[b].prior = sums[b][0];
    q[b].m = propagate<N>(p, at, v, scale, mixture<N>(p, at, sums[b]));
    expect<N, NY>(sensor, q[b]);
  }
}

/// Number of registers that are processed together. It is limited so that all sums fit into registers.
template <std::size_t N>
inline constexpr std::size_t most_together = N == 1   ? 4
                                             : N == 2 ? 2
                                                      : 1;

template <std::size_t N, std::size_t NY, std::size_t J = most_together<N>>
HWY_INLINE void predict_from(const ModeRows& p, const Sensor& sensor, const double* v, V scale, std::size_t r) {
  const std::size_t L = hn::Lanes(D());
  Prediction<N, NY> q[J];
  for (; r + J * L <= p.stride; r += J * L) {
    predict_registers<N, NY, J>(p, sensor, r, v, scale, q);
    for (std::size_t b = 0; b < J; ++b) store_prediction(q[b], p, r + b * L);
  }
  if constexpr (J > 1) predict_from<N, NY, J / 2>(p, sensor, v, scale, r);
}

template <std::size_t N, std::size_t NY>
void predict(const ModeRows& p, const Sensor& sensor, const double* v, double noise_scale) {
  predict_from<N, NY>(p, sensor, v, splat(noise_scale), 0);
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
