// What will be measured, and the step that takes a measurement in, a mode per lane. Included once per instruction set
// (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_UPDATE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_UPDATE_INL
#undef MODEBANK_VECTOR_IMM_UPDATE_INL
#else
#define MODEBANK_VECTOR_IMM_UPDATE_INL
#endif

#include "filter/step/detail/vector/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

template <std::size_t N, std::size_t NY>
void expect(const ModeRows& p, const Sensor& sensor) {
  const std::size_t stride = p.stride;
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    V x[N], P[packed_size(N)], PCt[N * NY], S[packed_size(NY)], L[packed_size(NY)], pivot[NY], inverse[NY];
    load_rows(p.predicted_mean + r, stride, x);
    load_rows(p.predicted_covariance + r, stride, P);
    times_sensor<N, NY>(P, sensor.C, PCt);
    for (std::size_t i = 0; i < NY; ++i) {
      V y = hn::Zero(D());
      for (std::size_t a = 0; a < N; ++a) y = hn::MulAdd(splat(sensor.C[i * N + a]), x[a], y);
      store(y, p.expected + i * stride + r);
      for (std::size_t k = 0; k <= i; ++k) {
        V sum = splat(sensor.R[i * NY + k]);
        for (std::size_t a = 0; a < N; ++a) sum = hn::MulAdd(splat(sensor.C[i * N + a]), PCt[a * NY + k], sum);
        S[packed(i, k)] = sum;
      }
    }
    for (std::size_t j = 0; j < NY; ++j) {
      V d = S[packed(j, j)];
      for (std::size_t k = 0; k < j; ++k) {
        const V l = L[packed(j, k)];
        d = hn::NegMulAdd(hn::Mul(l, l), pivot[k], d);
      }
      const V floor = hn::Max(hn::Mul(splat(relative_pivot_floor), hn::Abs(S[packed(j, j)])), splat(least_variance));
      pivot[j] = hn::Max(d, floor);
      inverse[j] = hn::Div(splat(1.0), pivot[j]);
      L[packed(j, j)] = splat(1.0);
      for (std::size_t i = j + 1; i < NY; ++i) {
        V sum = S[packed(i, j)];
        for (std::size_t k = 0; k < j; ++k)
          sum = hn::NegMulAdd(hn::Mul(L[packed(i, k)], L[packed(j, k)]), pivot[k], sum);
        L[packed(i, j)] = hn::Mul(sum, inverse[j]);
      }
    }
    store_rows(S, stride, p.innovation_covariance + r);
    store_rows(L, stride, p.L + r);
    store_rows(pivot, stride, p.D + r);
    store_rows(inverse, stride, p.D_inverse + r);
  }
}

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

/// One register of modes taking a measurement in.
template <std::size_t N, std::size_t NY>
struct Correction {
  V L[packed_size(NY)], inverse[NY], e[NY], z[NY];
  Moments<N> m;  // predicted

  HWY_INLINE Correction(const ModeRows& p, const double* y, std::size_t r) {
    load_rows(p.L + r, p.stride, L);
    load_rows(p.D_inverse + r, p.stride, inverse);
    load_rows(p.predicted_mean + r, p.stride, m.x);
    load_rows(p.predicted_covariance + r, p.stride, m.P);
    for (std::size_t i = 0; i < NY; ++i) e[i] = z[i] = hn::Sub(splat(y[i]), load(p.expected + i * p.stride + r));
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

  /// The estimate after the measurement; an overflowing correction is no information.
  HWY_INLINE Moments<N> posterior(const Sensor& sensor) const {
    V gain[N][NY];
    gain_of(sensor, gain);
    Moments<N> result = joseph(sensor, gain);
    V check = result.x[0], least = result.P[0];
    for (std::size_t a = 1; a < N; ++a) check = hn::Add(check, result.x[a]);
    for (const V P : result.P) check = hn::Add(check, P);
    for (std::size_t a = 1; a < N; ++a) least = hn::Min(least, result.P[packed(a, a)]);
    const M sound = hn::Lt(hn::Abs(check), splat(far)), negative = hn::Lt(least, zero());
    if (HWY_LIKELY(hn::AllTrue(D(), hn::AndNot(negative, sound)))) return result;
    for (std::size_t a = 0; a < N; ++a) result.x[a] = hn::IfThenElse(sound, result.x[a], m.x[a]);
    for (std::size_t k = 0; k < packed_size(N); ++k) result.P[k] = hn::IfThenElse(sound, result.P[k], m.P[k]);
    bound_variances(hn::And(sound, negative), result);
    return result;
  }

  /// As bound_variances of kalman.hpp does, where a variance is negative.
  HWY_INLINE void bound_variances(M negative, Moments<N>& posterior) const {
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        V& P = posterior.P[packed(a, b)];
        const V bounded = a == b ? hn::Max(zero(), hn::Min(P, m.P[packed(a, a)])) : zero();
        P = hn::IfThenElse(negative, bounded, P);
      }
  }
};

/// tr(S^-1 C s Q C') and e' S^-1 C s Q C' S^-1 e of the modes r .., the latter with e' S^-1 e cut (noise_scale.hpp).
template <std::size_t N, std::size_t NY>
HWY_INLINE void explained(const ModeRows& p, const Sensor& sensor, const double* y, std::size_t r, V& share,
                          V& square) {
  const Correction<N, NY> c(p, y, r);
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

/// Probabilities after the measurement, of `weights` that sum to `sum`: no mode dies for good.
HWY_INLINE void floor_probabilities(const ModeRows& p, const double* weights, double sum) {
  const V floor = splat(mode_probability_floor * sum);
  V total = hn::Zero(D());
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D())) {
    const M there = hn::FirstN(D(), p.modes > r ? p.modes - r : 0);
    const V kept = hn::IfThenElseZero(there, hn::Max(load(weights + r), floor));
    total = hn::Add(total, kept);
    store(kept, p.probability + r);
  }
  const V normal = splat(1.0 / sum_of(total));
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D()))
    store(hn::Mul(load(p.probability + r), normal), p.probability + r);
}

/// The mean of all modes, before rare ones are floored: it need not be exact, and no mixing has to wait for that.
template <std::size_t N>
HWY_INLINE void center_modes(const ModeRows& p, const double* weights, double sum) {
  for (std::size_t a = 0; a < N; ++a) {
    V moment = zero();
    for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D()))
      moment = hn::MulAdd(load(weights + r), load(p.mean + a * p.stride + r), moment);
    p.center[a] = sum_of(moment) / sum;
  }
}

template <std::size_t N, std::size_t NY>
UpdateResult update(const ModeRows& p, const Sensor& sensor, const double* y, double noise_scale) {
  const std::size_t stride = p.stride;
  V nearest = splat(far);
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const Correction<N, NY> c(p, y, r);
    const V prior = load(p.predicted_probability + r);
    const M possible = hn::Ge(prior, splat(impossible_probability));
    const V distance = hn::IfThenElse(possible, c.distance(), splat(far));
    nearest = hn::Min(nearest, distance);
    store_rows(c.z, stride, p.decorrelated + r);
    store(distance, p.distance + r);
    store(hn::IfThenElseZero(possible, hn::Mul(prior, c.root_determinant_inverse())), p.weight + r);
    const Moments<N> posterior = c.posterior(sensor);
    store_rows(posterior.x, stride, p.mean + r);
    store_rows(posterior.P, stride, p.covariance + r);
  }
  nearest = hn::MinOfLanes(D(), nearest);
  V sum = hn::Zero(D()), share = sum, square = sum;
  const Exp exp;
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const V exponent = hn::Mul(splat(-0.5), hn::Sub(load(p.distance + r), nearest));
    const V w = hn::Mul(load(p.weight + r), exp(exponent));
    store(w, p.weight + r);
    sum = hn::Add(sum, w);
    if (noise_scale > 0.0) {
      V share_r, square_r;
      explained<N, NY>(p, sensor, y, r, share_r, square_r);
      share = hn::MulAdd(w, share_r, share);
      square = hn::MulAdd(w, square_r, square);
    }
  }
  const double total = sum_of(sum);
  UpdateResult result;
  const hn::CappedTag<double, 1> one;
  result.log_density = hn::GetLane(hn::Log(one, hn::Set(one, total))) -
                       0.5 * (static_cast<double>(NY) * log_two_pi + hn::GetLane(nearest));
  if (noise_scale > 0.0) {
    result.share = noise_scale * sum_of(share) / total;
    result.square = noise_scale * sum_of(square) / total;
  }
  center_modes<N>(p, p.weight, total);
  floor_probabilities(p, p.weight, total);
  return result;
}

template <std::size_t N>
void skip(const ModeRows& p) {
  for (std::size_t i = 0; i < N * p.stride; ++i) p.mean[i] = p.predicted_mean[i];
  for (std::size_t i = 0; i < packed_size(N) * p.stride; ++i) p.covariance[i] = p.predicted_covariance[i];
  center_modes<N>(p, p.predicted_probability, 1.0);
  floor_probabilities(p, p.predicted_probability, 1.0);
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
