// Adjoint of one step, one mode per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_REVERSE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_REVERSE_INL
#undef MODEBANK_VECTOR_IMM_REVERSE_INL
#else
#define MODEBANK_VECTOR_IMM_REVERSE_INL
#endif

#include "filter/step/detail/vector/correct-inl.hpp"
#include "filter/step/detail/vector/interval_reverse-inl.hpp"
#include "filter/step/detail/vector/mixing-inl.hpp"
#include "filter/step/detail/vector/reverse.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// Weight of a packed entry. Sums such as v' P w count off-diagonal entries twice.
constexpr double times(std::size_t a, std::size_t b) { return a == b ? 1.0 : 2.0; }

HWY_INLINE void add_to(double* row, V value) { store(hn::Add(load(row), value), row); }

/// G' P G for a symmetric P.
template <std::size_t N>
HWY_INLINE void between(const V (&G)[N * N], const V (&P)[packed_size(N)], V (&result)[packed_size(N)]) {
  V PG[N * N];
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b < N; ++b) {
      PG[a * N + b] = hn::Mul(P[packed(a, 0)], G[b]);
      for (std::size_t k = 1; k < N; ++k) PG[a * N + b] = hn::MulAdd(P[packed(a, k)], G[k * N + b], PG[a * N + b]);
    }
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      V sum = hn::Mul(G[a], PG[b]);
      for (std::size_t k = 1; k < N; ++k) sum = hn::MulAdd(G[k * N + a], PG[k * N + b], sum);
      result[packed(a, b)] = sum;
    }
}

/// C' W for signals.
template <std::size_t N, std::size_t NY>
HWY_INLINE void to_state(const Sensor& sensor, const V (&w)[NY], V (&result)[N]) {
  for (std::size_t a = 0; a < N; ++a) {
    result[a] = hn::Mul(splat(sensor.C[a]), w[0]);
    for (std::size_t i = 1; i < NY; ++i) result[a] = hn::MulAdd(splat(sensor.C[i * N + a]), w[i], result[a]);
  }
}

/// result += C' W C for a symmetric W.
template <std::size_t N, std::size_t NY>
HWY_INLINE void add_to_state(const Sensor& sensor, const V (&W)[packed_size(NY)], V (&result)[packed_size(N)]) {
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b <= a; ++b)
      for (std::size_t i = 0; i < NY; ++i)
        for (std::size_t k = 0; k < NY; ++k)
          result[packed(a, b)] =
              hn::MulAdd(splat(sensor.C[i * N + a] * sensor.C[k * N + b]), W[packed(i, k)], result[packed(a, b)]);
}

/// Adjoint of the measurement equations for one register of modes.
template <std::size_t N, std::size_t NY>
struct Uncorrection {
  const Correction<N, NY> c;
  V pulled[NY], S_inverse[packed_size(NY)];  // S^-1 e, S^-1

  HWY_INLINE Uncorrection(const Prediction<N, NY>& q, const double* y) : c(q, y) {
    for (std::size_t i = 0; i < NY; ++i) pulled[i] = c.e[i];
    solve<NY>(c.L, c.inverse, pulled);
    for (std::size_t k = 0; k < NY; ++k) {
      V unit[NY];
      for (std::size_t i = 0; i < NY; ++i) unit[i] = splat(i == k ? 1.0 : 0.0);
      solve<NY>(c.L, c.inverse, unit);
      for (std::size_t i = k; i < NY; ++i) S_inverse[packed(i, k)] = unit[i];
    }
  }

  /// S_inverse times a vector.
  HWY_INLINE void weigh(const V (&w)[NY], V (&result)[NY]) const {
    for (std::size_t i = 0; i < NY; ++i) {
      result[i] = hn::Mul(S_inverse[packed(i, 0)], w[0]);
      for (std::size_t k = 1; k < NY; ++k) result[i] = hn::MulAdd(S_inverse[packed(i, k)], w[k], result[i]);
    }
  }

  /// Derivatives of the log density, times `by_log`, with respect to S.
  HWY_INLINE void log_density(V by_log, V (&by_S)[packed_size(NY)]) const {
    const V half = hn::Mul(splat(0.5), by_log);
    for (std::size_t i = 0; i < NY; ++i)
      for (std::size_t k = 0; k <= i; ++k)
        by_S[packed(i, k)] = hn::Mul(half, hn::MulSub(pulled[i], pulled[k], S_inverse[packed(i, k)]));
  }

  /// Derivatives of share tr(S^-1 C Q C') + square e' S^-1 C Q C' S^-1 e with respect to e, S (added) and Q. The term
  /// with `square` is limited (noise_scale.hpp).
  HWY_INLINE void explained(const Sensor& sensor, const V (&Q)[packed_size(N)], V share, V square, V (&by_e)[NY],
                            V (&by_S)[packed_size(NY)], V (&by_Q)[packed_size(N)]) const {
    const V most = splat(largest_standardised * largest_standardised * sensor.signals), nis = c.distance();
    const M cut = hn::Gt(nis, most);
    square = hn::IfThenElse(cut, hn::Div(hn::Mul(square, most), hn::Max(nis, most)), square);
    V QCt[N * NY], M_[NY][NY], weighed[NY][NY];  // C Q C', S^-1 C Q C'
    times_sensor<N, NY>(Q, sensor.C, QCt);
    for (std::size_t i = 0; i < NY; ++i)
      for (std::size_t k = 0; k < NY; ++k) {
        M_[i][k] = hn::Mul(splat(sensor.C[k * N]), QCt[i]);
        for (std::size_t a = 1; a < N; ++a)
          M_[i][k] = hn::MulAdd(splat(sensor.C[k * N + a]), QCt[a * NY + i], M_[i][k]);
      }
    for (std::size_t k = 0; k < NY; ++k) weigh(M_[k], weighed[k]);  // column k
    V along[NY], pull[NY], value = zero();
    for (std::size_t i = 0; i < NY; ++i) {
      along[i] = hn::Mul(M_[i][0], pulled[0]);
      for (std::size_t k = 1; k < NY; ++k) along[i] = hn::MulAdd(M_[i][k], pulled[k], along[i]);
      value = hn::MulAdd(along[i], pulled[i], value);
    }
    weigh(along, pull);
    // If the limit applies, the square is `most` times value / nis.
    const V by_nis = hn::IfThenElseZero(cut, hn::Div(hn::Mul(hn::Neg(square), value), hn::Max(nis, most)));
    for (std::size_t i = 0; i < NY; ++i) {
      by_e[i] = hn::Mul(splat(2.0), hn::MulAdd(square, pull[i], hn::Mul(by_nis, pulled[i])));
      for (std::size_t k = 0; k <= i; ++k) {
        V sum = hn::Mul(hn::Neg(square), hn::MulAdd(pull[i], pulled[k], hn::Mul(pulled[i], pull[k])));
        sum = hn::NegMulAdd(by_nis, hn::Mul(pulled[i], pulled[k]), sum);
        V twice = zero();  // S^-1 C Q C' S^-1
        for (std::size_t l = 0; l < NY; ++l) twice = hn::MulAdd(weighed[l][i], S_inverse[packed(l, k)], twice);
        sum = hn::NegMulAdd(share, twice, sum);
        by_S[packed(i, k)] = hn::Add(by_S[packed(i, k)], sum);
      }
    }
    V by_M[packed_size(NY)];
    for (std::size_t i = 0; i < NY; ++i)
      for (std::size_t k = 0; k <= i; ++k)
        by_M[packed(i, k)] = hn::MulAdd(share, S_inverse[packed(i, k)], hn::Mul(square, hn::Mul(pulled[i], pulled[k])));
    add_to_state<N, NY>(sensor, by_M, by_Q);
  }

  /// Converts derivatives with respect to the corrected moments to those with respect to the predicted moments and R.
  /// `by_S`, `by_e`: derivatives of other terms that depend on S and e. The dependence of the log density on e is added
  /// with factor `by_log`.
  HWY_INLINE void back(const Sensor& sensor, V by_log, const V (&by_e)[NY], const V (&by_S)[packed_size(NY)],
                       Moments<N>& by, double* by_R) const {
    V gain[N][NY], closed[N * N], pull[N], from_e[N], x[N];
    c.gain_of(sensor, gain);
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b < N; ++b) {
        V sum = splat(a == b ? 1.0 : 0.0);
        for (std::size_t i = 0; i < NY; ++i) sum = hn::NegMulAdd(gain[a][i], splat(sensor.C[i * N + b]), sum);
        closed[a * N + b] = sum;
      }
    add_by_R(gain, by_S, by, by_R);
    for (std::size_t b = 0; b < N; ++b) {
      x[b] = hn::Mul(closed[b], by.x[0]);
      for (std::size_t a = 1; a < N; ++a) x[b] = hn::MulAdd(closed[a * N + b], by.x[a], x[b]);
    }
    to_state<N, NY>(sensor, pulled, pull);
    to_state<N, NY>(sensor, by_e, from_e);
    V P[packed_size(N)];
    between<N>(closed, by.P, P);
    add_to_state<N, NY>(sensor, by_S, P);
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b <= a; ++b)
        by.P[packed(a, b)] = hn::MulAdd(splat(0.5), hn::MulAdd(x[a], pull[b], hn::Mul(x[b], pull[a])), P[packed(a, b)]);
    for (std::size_t a = 0; a < N; ++a) by.x[a] = hn::Sub(hn::MulAdd(pull[a], by_log, x[a]), from_e[a]);
  }

 private:
  HWY_INLINE void add_by_R(const V (&gain)[N][NY], const V (&by_S)[packed_size(NY)], const Moments<N>& by,
                           double* by_R) const {
    V Pgain[N][NY], x[NY];  // by.P times K, and K' times by.x
    for (std::size_t i = 0; i < NY; ++i) {
      x[i] = zero();
      for (std::size_t a = 0; a < N; ++a) {
        x[i] = hn::MulAdd(gain[a][i], by.x[a], x[i]);
        Pgain[a][i] = zero();
        for (std::size_t b = 0; b < N; ++b) Pgain[a][i] = hn::MulAdd(by.P[packed(a, b)], gain[b][i], Pgain[a][i]);
      }
    }
    for (std::size_t i = 0; i < NY; ++i)
      for (std::size_t k = 0; k <= i; ++k) {
        V sum = by_S[packed(i, k)];
        for (std::size_t a = 0; a < N; ++a) sum = hn::MulAdd(gain[a][i], Pgain[a][k], sum);
        sum = hn::NegMulAdd(splat(0.5), hn::MulAdd(x[i], pulled[k], hn::Mul(x[k], pulled[i])), sum);
        by_R[packed(i, k)] += sum_of(sum);
      }
  }
};

/// Converts derivatives with respect to the predicted moments of register r to those with respect to the mixed moments
/// and F, B, c and Q. `by_scaled_Q`: derivative of other terms with respect to Q. Returns the derivative with respect
/// to the noise scale, lane by lane.
template <std::size_t N>
HWY_INLINE V back_to_mixed(const ModeRows& p, const ReverseStep& step, const ReverseRows& d, std::size_t r,
                           const Moments<N>& by, const V (&by_Q)[packed_size(N)]) {
  const std::size_t stride = p.stride;
  V F[N * N];
  load_rows(p.F + r, stride, F);
  const V prior = load(p.predicted_probability + r);
  const M possible = hn::Ge(prior, splat(impossible_probability));
  Moments<N> from;
  mix_apart(p, r, hn::Div(splat(1.0), hn::IfThenElse(possible, prior, splat(1.0))), from);
  for (std::size_t a = 0; a < N; ++a) from.x[a] = hn::IfThenElse(possible, from.x[a], load(p.mean + a * stride + r));
  for (std::size_t k = 0; k < packed_size(N); ++k)
    from.P[k] = hn::IfThenElse(possible, from.P[k], load(p.covariance + k * stride + r));
  for (std::size_t a = 0; a < N; ++a) {
    V PF[N];  // row a of by.P F
    for (std::size_t b = 0; b < N; ++b) {
      PF[b] = zero();
      for (std::size_t k = 0; k < N; ++k) PF[b] = hn::MulAdd(by.P[packed(a, k)], F[k * N + b], PF[b]);
    }
    for (std::size_t b = 0; b < N; ++b) {
      V sum = zero();
      for (std::size_t k = 0; k < N; ++k) sum = hn::MulAdd(PF[k], from.P[packed(k, b)], sum);
      add_to(d.F + (a * N + b) * stride + r, hn::MulAdd(by.x[a], from.x[b], hn::Add(sum, sum)));
    }
    for (std::size_t i = 0; i < p.inputs; ++i)
      add_to(d.B + (a * p.inputs + i) * stride + r, hn::Mul(by.x[a], splat(step.inputs[i])));
    add_to(d.c + a * stride + r, by.x[a]);
  }
  const V scale = splat(step.noise_scale);
  V by_scale = zero();
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      const std::size_t k = packed(a, b);
      by_scale = hn::MulAdd(hn::Mul(splat(times(a, b)), by.P[k]), load(p.Q + k * stride + r), by_scale);
      add_to(d.Q + k * stride + r, hn::MulAdd(scale, by.P[k], by_Q[k]));
    }
  V P[packed_size(N)];
  between<N>(F, by.P, P);
  store_rows(P, stride, d.by_mixed_covariance + r);
  store_rows(from.x, stride, d.mixed_mean + r);
  for (std::size_t b = 0; b < N; ++b) {
    V sum = hn::Mul(F[b], by.x[0]);
    for (std::size_t a = 1; a < N; ++a) sum = hn::MulAdd(F[a * N + b], by.x[a], sum);
    store(sum, d.by_mixed_mean + b * stride + r);
  }
  return by_scale;
}

/// Converts derivatives with respect to the start of mode j to those with respect to the state before the step and
/// column j of T.
template <std::size_t N>
HWY_INLINE void back_to_state(const ModeRows& p, const ReverseRows& d, std::size_t j) {
  const std::size_t stride = p.stride;
  const double prior = p.predicted_probability[j];
  if (!(prior >= impossible_probability)) {  // an impossible mode starts from its own state
    for (std::size_t a = 0; a < N; ++a) d.mean[a * stride + j] += d.by_mixed_mean[a * stride + j];
    for (std::size_t k = 0; k < packed_size(N); ++k)
      d.covariance[k * stride + j] += d.by_mixed_covariance[k * stride + j];
    return;
  }
  const double* T = d.transition_to + j * stride;
  const V inverse = splat(1.0 / prior);
  V by_x[N], by_P[packed_size(N)], mean = zero();
  for (std::size_t a = 0; a < N; ++a) by_x[a] = splat(d.by_mixed_mean[a * stride + j]);
  for (std::size_t k = 0; k < packed_size(N); ++k) by_P[k] = splat(d.by_mixed_covariance[k * stride + j]);
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const V w = hn::Mul(hn::Mul(load(T + r), load(p.probability + r)), inverse);
    V apart[N], pair = zero();
    for (std::size_t a = 0; a < N; ++a)
      apart[a] = hn::Sub(load(p.mean + a * stride + r), splat(d.mixed_mean[a * stride + j]));
    for (std::size_t a = 0; a < N; ++a) {
      V pull = hn::Mul(by_P[packed(a, 0)], apart[0]);
      for (std::size_t b = 1; b < N; ++b) pull = hn::MulAdd(by_P[packed(a, b)], apart[b], pull);
      pair = hn::MulAdd(apart[a], hn::Add(by_x[a], pull), pair);
      add_to(d.mean + a * stride + r, hn::Mul(w, hn::MulAdd(splat(2.0), pull, by_x[a])));
      for (std::size_t b = 0; b <= a; ++b) {
        const std::size_t k = packed(a, b);
        pair = hn::MulAdd(hn::Mul(splat(times(a, b)), by_P[k]), load(p.covariance + k * stride + r), pair);
        add_to(d.covariance + k * stride + r, hn::Mul(w, by_P[k]));
      }
    }
    store(pair, d.pair + r);
    mean = hn::MulAdd(w, pair, mean);
  }
  const V middle = splat(sum_of(mean)), by_prior = splat(d.by_prior[j]);
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    // Derivative with respect to T_ij mu_i
    const V by_product = hn::MulAdd(hn::Sub(load(d.pair + r), middle), inverse, by_prior);
    add_to(d.probability + r, hn::Mul(load(T + r), by_product));
    add_to(d.by_transition_to + j * stride + r, hn::Mul(load(p.probability + r), by_product));
  }
}

/// Replaces the derivatives by derivatives with respect to the probabilities before the floor. Includes the sums for
/// the noise scale. Returns the mean of the derivatives. A probability at the floor is constant.
template <std::size_t N, std::size_t NY>
HWY_INLINE V unfloor(const ModeRows& p, const ReverseStep& step, const ReverseRows& d) {
  V mean = zero();
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D())) {
    const V mu = load(step.probability_after + r);
    V by = hn::IfThenElseZero(hn::Gt(mu, splat(2.0 * mode_probability_floor)), load(d.probability + r));
    if (step.adaptive && step.measured) {
      V share, square;
      explained<N, NY>(p, step.sensor, step.measured, r, share, square);
      const V sums = hn::MulAdd(splat(step.by_share), share, hn::Mul(splat(step.by_square), square));
      by = hn::MulAdd(splat(step.noise_scale), sums, by);
    }
    store(by, d.probability + r);
    mean = hn::MulAdd(mu, by, mean);
  }
  return splat(sum_of(mean));
}

/// Converts derivatives with respect to the corrected moments of register r to those with respect to the predicted
/// moments, R and Q. `by_log`: derivative with respect to the mode's log density. `mu`: probability of the mode after
/// the measurement.
template <std::size_t N, std::size_t NY>
HWY_INLINE void back_to_predicted(const ModeRows& p, const ReverseStep& step, const ReverseRows& d, std::size_t r,
                                  V by_log, V mu, Moments<N>& by, V (&by_Q)[packed_size(N)]) {
  const V scaled = hn::Mul(mu, splat(step.noise_scale));
  const V share = hn::Mul(scaled, splat(step.by_share)), square = hn::Mul(scaled, splat(step.by_square));
  V Q[packed_size(N)];
  load_rows(p.Q + r, p.stride, Q);
  if (step.sensor.quantum)
    return IntervalUncorrection<N, NY>(p, step.sensor, r).back(by_log, share, square, Q, by, by_Q, d.R);
  const Uncorrection<N, NY> back(load_prediction<N, NY>(p, r), step.measured);
  V by_e[NY], by_S[packed_size(NY)];
  for (V& value : by_e) value = zero();
  back.log_density(by_log, by_S);
  if (step.adaptive) back.explained(step.sensor, Q, share, square, by_e, by_S, by_Q);
  back.back(step.sensor, by_log, by_e, by_S, by, d.R);
}

template <std::size_t N, std::size_t NY>
double reverse(const ModeRows& p, const ReverseStep& step, const ReverseRows& d) {
  const std::size_t stride = p.stride;
  if (step.measured && step.sensor.quantum)
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D()))
      look_at<N, NY>(p, step.sensor, step.measured, r, load_prediction<N, NY>(p, r).m);
  const V mean = unfloor<N, NY>(p, step, d);
  V by_scale = zero();
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    Moments<N> by;
    load_rows(d.mean + r, stride, by.x);
    load_rows(d.covariance + r, stride, by.P);
    const V by_probability = load(d.probability + r);
    V by_Q[packed_size(N)];
    for (V& value : by_Q) value = zero();
    V by_prior = by_probability;
    if (step.measured) {
      const V mu = load(step.probability_after + r);
      const V by_log = hn::Mul(mu, hn::Add(splat(step.weight), hn::Sub(by_probability, mean)));
      back_to_predicted<N, NY>(p, step, d, r, by_log, mu, by, by_Q);
      by_prior = hn::Div(by_log, hn::Max(load(p.predicted_probability + r), splat(impossible_probability)));
    }
    store(by_prior, d.by_prior + r);
    by_scale = hn::Add(by_scale, back_to_mixed<N>(p, step, d, r, by, by_Q));
  }
  for (std::size_t i = 0; i < N * stride; ++i) d.mean[i] = 0.0;
  for (std::size_t i = 0; i < packed_size(N) * stride; ++i) d.covariance[i] = 0.0;
  for (std::size_t i = 0; i < stride; ++i) d.probability[i] = 0.0;
  for (std::size_t j = 0; j < p.modes; ++j) back_to_state<N>(p, d, j);
  return sum_of(by_scale);
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
