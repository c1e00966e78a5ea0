// Predicts the measurement, one mode per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_EXPECT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_EXPECT_INL
#undef MODEBANK_VECTOR_IMM_EXPECT_INL
#else
#define MODEBANK_VECTOR_IMM_EXPECT_INL
#endif

#include "filter/step/detail/vector/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// Prediction of one register of modes, and of its measurement: S = L D L'.
template <std::size_t N, std::size_t NY>
struct Prediction {
  V prior;
  Moments<N> m;
  V y[NY], S[packed_size(NY)], L[packed_size(NY)], D[NY], inverse[NY];
};

/// C x, S and its factor for the modes of register r.
template <std::size_t N, std::size_t NY>
HWY_INLINE void expect(const Sensor& sensor, Prediction<N, NY>& q) {
  V PCt[N * NY];
  times_sensor<N, NY>(q.m.P, sensor.C, PCt);
  for (std::size_t i = 0; i < NY; ++i) {
    q.y[i] = hn::Zero(D());
    for (std::size_t a = 0; a < N; ++a) q.y[i] = hn::MulAdd(splat(sensor.C[i * N + a]), q.m.x[a], q.y[i]);
    for (std::size_t k = 0; k <= i; ++k) {
      V sum = splat(sensor.R[i * NY + k]);
      for (std::size_t a = 0; a < N; ++a) sum = hn::MulAdd(splat(sensor.C[i * N + a]), PCt[a * NY + k], sum);
      q.S[packed(i, k)] = sum;
    }
  }
  for (std::size_t j = 0; j < NY; ++j) {
    V d = q.S[packed(j, j)];
    for (std::size_t k = 0; k < j; ++k) {
      const V l = q.L[packed(j, k)];
      d = hn::NegMulAdd(hn::Mul(l, l), q.D[k], d);
    }
    const V floor = hn::Max(hn::Mul(splat(relative_pivot_floor), hn::Abs(q.S[packed(j, j)])), splat(least_variance));
    q.D[j] = hn::Max(d, floor);
    q.inverse[j] = hn::Div(splat(1.0), q.D[j]);
    q.L[packed(j, j)] = splat(1.0);
    for (std::size_t i = j + 1; i < NY; ++i) {
      V sum = q.S[packed(i, j)];
      for (std::size_t k = 0; k < j; ++k)
        sum = hn::NegMulAdd(hn::Mul(q.L[packed(i, k)], q.L[packed(j, k)]), q.D[k], sum);
      q.L[packed(i, j)] = hn::Mul(sum, q.inverse[j]);
    }
  }
}

template <std::size_t N, std::size_t NY>
HWY_INLINE void store_prediction(const Prediction<N, NY>& q, const ModeRows& p, std::size_t r) {
  store(q.prior, p.predicted_probability + r);
  store_rows(q.m.x, p.stride, p.predicted_mean + r);
  store_rows(q.m.P, p.stride, p.predicted_covariance + r);
  store_rows(q.y, p.stride, p.expected + r);
  store_rows(q.S, p.stride, p.innovation_covariance + r);
  store_rows(q.L, p.stride, p.L + r);
  store_rows(q.D, p.stride, p.D + r);
  store_rows(q.inverse, p.stride, p.D_inverse + r);
}

/// Reads the values that store_prediction wrote. Skips S and D, which a correction does not need.
template <std::size_t N, std::size_t NY>
HWY_INLINE Prediction<N, NY> load_prediction(const ModeRows& p, std::size_t r) {
  Prediction<N, NY> q;
  q.prior = load(p.predicted_probability + r);
  load_rows(p.predicted_mean + r, p.stride, q.m.x);
  load_rows(p.predicted_covariance + r, p.stride, q.m.P);
  load_rows(p.expected + r, p.stride, q.y);
  load_rows(p.L + r, p.stride, q.L);
  load_rows(p.D_inverse + r, p.stride, q.inverse);
  return q;
}

template <std::size_t N, std::size_t NY>
void expect(const ModeRows& p, const Sensor& sensor) {
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D())) {
    Prediction<N, NY> q = load_prediction<N, NY>(p, r);
    expect<N, NY>(sensor, q);
    store_prediction(q, p, r);
  }
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
