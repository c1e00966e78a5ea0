// Updates modes with quantised measurements (equations/interval.hpp), one mode per lane. Included once per instruction
// set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_INTERVAL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_INTERVAL_INL
#undef MODEBANK_VECTOR_IMM_INTERVAL_INL
#else
#define MODEBANK_VECTOR_IMM_INTERVAL_INL
#endif

#include "filter/step/detail/vector/correct-inl.hpp"
#include "filter/step/detail/vector/truncated-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// Moments of signal i for the modes of register r. The rows of innovation and variance are the inputs.
template <std::size_t NY>
HWY_NOINLINE void look_at_signal(const ModeRows& p, double quantum, std::size_t i, std::size_t r) {
  const M there = hn::FirstN(D(), p.modes > r ? p.modes - r : 0);  // padding lanes get an interval that is cheap to
                                                                   // compute
  const V e = hn::IfThenElseZero(there, load(p.decorrelated + i * p.stride + r));
  const V s = hn::IfThenElse(there, load(p.D + i * p.stride + r), splat(quantum > 0.0 ? quantum * quantum : 1.0));
  const Signals said = signal_likelihood(e, s, quantum);
  double* to = p.signal + i * p.stride + r;
  for (const V number : {said.log_density, said.mean, said.variance, said.third, said.fourth}) {
    store(number, to);
    to += NY * p.stride;
  }
}

/// Element `which` of SignalLikelihood.
template <std::size_t NY>
HWY_INLINE V signal_moment(const ModeRows& p, std::size_t which, std::size_t i, std::size_t r) {
  return load(p.signal + (which * NY + i) * p.stride + r);
}

/// Updates one register of modes with the signals one after another.
template <std::size_t N, std::size_t NY>
struct IntervalCorrection {
  Moments<N> m;  ///< moments after the signals that were processed so far
  V column[N];   ///< P C_i'
  V s;           ///< C_i P C_i' + R_ii

  HWY_INLINE explicit IntervalCorrection(const Moments<N>& predicted) : m(predicted) {}

  HWY_INLINE void expect(const Sensor& sensor, std::size_t i) {
    s = splat(sensor.R[i * NY + i]);
    for (std::size_t a = 0; a < N; ++a) {
      column[a] = hn::Mul(m.P[packed(a, 0)], splat(sensor.C[i * N]));
      for (std::size_t b = 1; b < N; ++b)
        column[a] = hn::MulAdd(m.P[packed(a, b)], splat(sensor.C[i * N + b]), column[a]);
    }
    for (std::size_t a = 0; a < N; ++a) s = hn::MulAdd(splat(sensor.C[i * N + a]), column[a], s);
    s = hn::Max(s, splat(least_variance));
  }
  HWY_INLINE V innovation(const Sensor& sensor, const double* y, std::size_t i) const {
    V e = splat(y[i]);
    for (std::size_t a = 0; a < N; ++a) e = hn::NegMulAdd(splat(sensor.C[i * N + a]), m.x[a], e);
    return e;
  }
  /// Updates the moments, given mean and variance of the standardised innovation.
  HWY_INLINE void take(V mean, V variance) {
    const V step = hn::Div(mean, hn::Sqrt(s)), shrink = hn::Div(hn::Sub(splat(1.0), variance), s);
    for (std::size_t a = 0; a < N; ++a) {
      m.x[a] = hn::MulAdd(step, column[a], m.x[a]);
      for (std::size_t b = 0; b <= a; ++b)
        m.P[packed(a, b)] = hn::NegMulAdd(hn::Mul(shrink, column[a]), column[b], m.P[packed(a, b)]);
    }
  }
};

/// Computes `decorrelated`, `D` and `signal` for all signals and the modes of register r, and then the moments after
/// the measurement.
template <std::size_t N, std::size_t NY>
HWY_INLINE Moments<N> look_at(const ModeRows& p, const Sensor& sensor, const double* y, std::size_t r,
                              const Moments<N>& predicted) {
  IntervalCorrection<N, NY> c(predicted);
  for (std::size_t i = 0; i < NY; ++i) {
    c.expect(sensor, i);
    store(c.innovation(sensor, y, i), p.decorrelated + i * p.stride + r);
    store(c.s, p.D + i * p.stride + r);
    look_at_signal<NY>(p, sensor.quantum[i], i, r);
    c.take(signal_moment<NY>(p, 1, i, r), signal_moment<NY>(p, 2, i, r));
  }
  return c.m;
}

/// Like `correct` in update-inl.hpp, but `exponents` holds complete log densities, which may be positive.
template <std::size_t N, std::size_t NY>
HWY_NOINLINE V correct_intervals(const ModeRows& p, const Sensor& sensor, const double* y) {
  V largest = splat(-far);
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D())) {
    const Prediction<N, NY> q = load_prediction<N, NY>(p, r);
    const Moments<N> posterior = usable<N>(q.m, look_at<N, NY>(p, sensor, y, r, q.m));
    V log_density = splat(0.5 * static_cast<double>(NY) * log_two_pi);
    for (std::size_t i = 0; i < NY; ++i) log_density = hn::Add(log_density, signal_moment<NY>(p, 0, i, r));
    const M possible = hn::And(hn::Ge(q.prior, splat(impossible_probability)), hn::Gt(log_density, splat(-far)));
    const V exponent = hn::IfThenElse(possible, hn::Mul(splat(log2_e), log_density), splat(-far));
    largest = hn::Max(largest, exponent);
    store(exponent, p.exponent + r);
    store(hn::IfThenElseZero(hn::Ge(q.prior, splat(impossible_probability)), q.prior), p.weight + r);
    store_rows(posterior.x, p.stride, p.mean + r);
    store_rows(posterior.P, p.stride, p.covariance + r);
  }
  return hn::MaxOfLanes(D(), largest);
}

/// C_i P C_i' for a packed P.
template <std::size_t N>
HWY_INLINE V along_signal(const Sensor& sensor, std::size_t i, const V (&P)[packed_size(N)]) {
  V sum = zero();
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b < N; ++b)
      sum = hn::MulAdd(splat(sensor.C[i * N + a] * sensor.C[i * N + b]), P[packed(a, b)], sum);
  return sum;
}

/// E[e^2 / s | interval] for signal i.
template <std::size_t NY>
HWY_INLINE V second_moment(const ModeRows& p, std::size_t i, std::size_t r) {
  const V mean = signal_moment<NY>(p, 1, i, r);
  return hn::MulAdd(mean, mean, signal_moment<NY>(p, 2, i, r));
}

/// Like `interval_sums` of interval.hpp.
template <std::size_t N, std::size_t NY>
HWY_INLINE void explained_by_intervals(const ModeRows& p, const Sensor& sensor, std::size_t r, V& share, V& square) {
  V Q[packed_size(N)];
  load_rows(p.Q + r, p.stride, Q);
  share = square = zero();
  for (std::size_t i = 0; i < NY; ++i) {
    const V of_signal = hn::Div(along_signal<N>(sensor, i, Q), load(p.D + i * p.stride + r));
    share = hn::Add(share, of_signal);
    square = hn::MulAdd(
        of_signal, hn::Min(second_moment<NY>(p, i, r), splat(largest_standardised * largest_standardised)), square);
  }
}

/// The sums for the noise scale of the modes r .., after the measurement.
template <std::size_t N, std::size_t NY>
HWY_INLINE void explained(const ModeRows& p, const Sensor& sensor, const double* y, std::size_t r, V& share,
                          V& square) {
  if (sensor.quantum) return explained_by_intervals<N, NY>(p, sensor, r, share, square);
  explained_by_values<N, NY>(p, sensor, y, r, share, square);
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
