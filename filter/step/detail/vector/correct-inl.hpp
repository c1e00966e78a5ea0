// Updates modes with a measurement, one mode per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_CORRECT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_CORRECT_INL
#undef MODEBANK_VECTOR_IMM_CORRECT_INL
#else
#define MODEBANK_VECTOR_IMM_CORRECT_INL
#endif

#include "filter/step/detail/vector/expect-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// v := L^-1 v, and v := S^-1 v.
template <std::size_t NY>
HWY_INLINE void decorrelate(const V (&L)[packed_size(NY)], V (&v)[NY]) {
  for (std::size_t i = 1; i < NY; ++i)
    for (std::size_t k = 0; k < i; ++k) v[i] = hn::NegMulAdd(L[packed(i, k)], v[k], v[i]);
}
template <std::size_t NY>
HWY_INLINE void solve(const V (&L)[packed_size(NY)], const V (&inverse)[NY], V (&v)[NY]) {
  decorrelate<NY>(L, v);
  for (std::size_t i = NY; i-- > 0;) {
    v[i] = hn::Mul(v[i], inverse[i]);
    for (std::size_t k = i + 1; k < NY; ++k) v[i] = hn::NegMulAdd(L[packed(k, i)], v[k], v[i]);
  }
}

/// Like bound_variances of kalman.hpp, in the lanes where `negative` is true.
template <std::size_t N>
HWY_INLINE void bound_variances(M negative, const Moments<N>& predicted, Moments<N>& posterior) {
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      V& P = posterior.P[packed(a, b)];
      const V bounded = a == b ? hn::Max(zero(), hn::Min(P, predicted.P[packed(a, a)])) : zero();
      P = hn::IfThenElse(negative, bounded, P);
    }
}

/// The estimate after the measurement. A correction that overflows is ignored.
template <std::size_t N>
HWY_INLINE Moments<N> usable(const Moments<N>& predicted, Moments<N> result) {
  V check = result.x[0], least = result.P[0];
  for (std::size_t a = 1; a < N; ++a) check = hn::Add(check, result.x[a]);
  for (const V P : result.P) check = hn::Add(check, P);
  for (std::size_t a = 1; a < N; ++a) least = hn::Min(least, result.P[packed(a, a)]);
  const M sound = hn::Lt(hn::Abs(check), splat(far)), negative = hn::Lt(least, zero());
  if (HWY_LIKELY(hn::AllTrue(D(), hn::AndNot(negative, sound)))) return result;
  for (std::size_t a = 0; a < N; ++a) result.x[a] = hn::IfThenElse(sound, result.x[a], predicted.x[a]);
  for (std::size_t k = 0; k < packed_size(N); ++k) result.P[k] = hn::IfThenElse(sound, result.P[k], predicted.P[k]);
  bound_variances<N>(hn::And(sound, negative), predicted, result);
  return result;
}

/// Updates one register of modes with a measurement.
template <std::size_t N, std::size_t NY>
struct Correction {
  const Moments<N> m;  // predicted moments
  V L[packed_size(NY)], inverse[NY], e[NY], z[NY];

  HWY_INLINE Correction(const Prediction<N, NY>& q, const double* y) : m(q.m) {
    for (std::size_t k = 0; k < packed_size(NY); ++k) L[k] = q.L[k];
    for (std::size_t i = 0; i < NY; ++i) inverse[i] = q.inverse[i];
    for (std::size_t i = 0; i < NY; ++i) e[i] = z[i] = hn::Sub(splat(y[i]), q.y[i]);
    decorrelate<NY>(L, z);
  }

  HWY_INLINE V distance() const {
    V sum = hn::Mul(hn::Mul(z[0], z[0]), inverse[0]);
    for (std::size_t i = 1; i < NY; ++i) sum = hn::MulAdd(hn::Mul(z[i], z[i]), inverse[i], sum);
    return sum;
  }
  HWY_INLINE V root_determinant_inverse() const {
    V product = inverse[0];
    for (std::size_t i = 1; i < NY; ++i) product = hn::Mul(product, inverse[i]);
    return hn::Sqrt(product);
  }

  /// The gain K = P C' S^-1, row by row.
  HWY_INLINE void gain_of(const Sensor& sensor, V (&gain)[N][NY]) const {
    V PCt[N * NY];
    times_sensor<N, NY>(m.P, sensor.C, PCt);
    for (std::size_t a = 0; a < N; ++a) {
      for (std::size_t i = 0; i < NY; ++i) gain[a][i] = PCt[a * NY + i];
      solve<NY>(L, inverse, gain[a]);
    }
  }

  /// x + K e and, in Joseph's form, (I - K C) P (I - K C)' + K R K'.
  HWY_INLINE Moments<N> joseph(const Sensor& sensor, const V (&gain)[N][NY]) const {
    V closed[N * N], product[N], gainR[NY];
    Moments<N> result;
    for (std::size_t a = 0; a < N; ++a) {
      result.x[a] = m.x[a];
      for (std::size_t i = 0; i < NY; ++i) result.x[a] = hn::MulAdd(gain[a][i], e[i], result.x[a]);
      for (std::size_t b = 0; b < N; ++b) {
        V sum = splat(a == b ? 1.0 : 0.0);
        for (std::size_t i = 0; i < NY; ++i) sum = hn::NegMulAdd(gain[a][i], splat(sensor.C[i * N + b]), sum);
        closed[a * N + b] = sum;
      }
    }
    for (std::size_t a = 0; a < N; ++a) {
      for (std::size_t b = 0; b < N; ++b) {
        product[b] = hn::Mul(closed[a * N], m.P[packed(0, b)]);
        for (std::size_t k = 1; k < N; ++k) product[b] = hn::MulAdd(closed[a * N + k], m.P[packed(k, b)], product[b]);
      }
      for (std::size_t k = 0; k < NY; ++k) {
        gainR[k] = hn::Mul(gain[a][0], splat(sensor.R[k]));
        for (std::size_t i = 1; i < NY; ++i) gainR[k] = hn::MulAdd(gain[a][i], splat(sensor.R[i * NY + k]), gainR[k]);
      }
      for (std::size_t b = 0; b <= a; ++b) {
        V sum = hn::Mul(gainR[0], gain[b][0]);
        for (std::size_t i = 1; i < NY; ++i) sum = hn::MulAdd(gainR[i], gain[b][i], sum);
        for (std::size_t k = 0; k < N; ++k) sum = hn::MulAdd(product[k], closed[b * N + k], sum);
        result.P[packed(a, b)] = sum;
      }
    }
    return result;
  }

  HWY_INLINE Moments<N> posterior(const Sensor& sensor) const {
    V gain[N][NY];
    gain_of(sensor, gain);
    return usable<N>(m, joseph(sensor, gain));
  }
};

/// Two sums of the modes r ..: tr(S^-1 C s Q C') and e' S^-1 C s Q C' S^-1 e. In the second one, e' S^-1 e is limited
/// (noise_scale.hpp).
template <std::size_t N, std::size_t NY>
HWY_INLINE void explained_by_values(const ModeRows& p, const Sensor& sensor, const double* y, std::size_t r, V& share,
                                    V& square) {
  const Correction<N, NY> c(load_prediction<N, NY>(p, r), y);
  V Q[packed_size(N)], QCt[N * NY];
  load_rows(p.Q + r, p.stride, Q);
  times_sensor<N, NY>(Q, sensor.C, QCt);
  V CQC[NY][NY];
  for (std::size_t i = 0; i < NY; ++i)
    for (std::size_t k = 0; k < NY; ++k) {
      V sum = hn::Mul(splat(sensor.C[k * N]), QCt[i]);
      for (std::size_t a = 1; a < N; ++a) sum = hn::MulAdd(splat(sensor.C[k * N + a]), QCt[a * NY + i], sum);
      CQC[i][k] = sum;  // column i of C Q C'
    }
  V pulled[NY];
  for (std::size_t i = 0; i < NY; ++i) pulled[i] = c.e[i];
  solve<NY>(c.L, c.inverse, pulled);
  share = square = hn::Zero(D());
  for (std::size_t i = 0; i < NY; ++i) {
    V along = hn::Zero(D());
    for (std::size_t k = 0; k < NY; ++k) along = hn::MulAdd(CQC[i][k], pulled[k], along);
    square = hn::MulAdd(along, pulled[i], square);
    solve<NY>(c.L, c.inverse, CQC[i]);
    share = hn::Add(share, CQC[i][i]);
  }
  const V most = splat(largest_standardised * largest_standardised * sensor.signals), nis = c.distance();
  square = hn::IfThenElse(hn::Gt(nis, most), hn::Mul(square, hn::Div(most, hn::Max(nis, most))), square);
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
