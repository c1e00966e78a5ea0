// Adjoint of the update with quantised measurements, one mode per lane. Included once per instruction set (Highway's
// foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_INTERVAL_REVERSE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_INTERVAL_REVERSE_INL
#undef MODEBANK_VECTOR_IMM_INTERVAL_REVERSE_INL
#else
#define MODEBANK_VECTOR_IMM_INTERVAL_REVERSE_INL
#endif

#include "filter/step/detail/vector/interval-inl.hpp"
#include "filter/step/detail/vector/reverse.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// Derivatives of one signal with respect to its innovation and variance. Also with respect to mean M and variance V of
/// the innovation given its interval (SignalLikelihood).
struct BySignal {
  V e, s, mean, variance;
};

/// Adjoint of one register of modes for quantised signals. Call look_at for the register first.
template <std::size_t N, std::size_t NY>
class IntervalUncorrection {
 public:
  HWY_INLINE IntervalUncorrection(const ModeRows& p, const Sensor& sensor, std::size_t r)
      : p_(p), sensor_(sensor), r_(r) {
    IntervalCorrection<N, NY> c(load_prediction<N, NY>(p, r).m);
    for (std::size_t i = 0; i < NY; ++i) {
      c.expect(sensor, i);
      for (std::size_t a = 0; a < N; ++a) column_[i][a] = c.column[a];
      c.take(signal_moment<NY>(p, 1, i, r), signal_moment<NY>(p, 2, i, r));
    }
  }

  /// Converts derivatives with respect to the corrected moments to those with respect to the predicted moments. Adds
  /// derivatives with respect to R and Q. The objective is `by_log` times the log density, plus `share` and `square`
  /// times the sums for the noise scale.
  HWY_INLINE void back(V by_log, V share, V square, const V (&Q)[packed_size(N)], Moments<N>& by,
                       V (&by_Q)[packed_size(N)], double* by_R) const {
    for (std::size_t i = NY; i-- > 0;) {
      const V inverse = hn::Div(splat(1.0), load(p_.D + i * p_.stride + r_));
      const V root = hn::Sqrt(load(p_.D + i * p_.stride + r_));
      const V mean = moment(1, i), variance = moment(2, i), third = moment(3, i), fourth = moment(4, i);
      const V(&column)[N] = column_[i];
      // The correction is x + column M / s, P - column column' (s - V) / s^2.
      V by_column[N], by_step = zero(), by_shrink = zero();
      const V step = hn::Div(mean, root), shrink = hn::Mul(hn::Sub(splat(1.0), variance), inverse);
      for (std::size_t a = 0; a < N; ++a) {
        V pull = zero();
        for (std::size_t b = 0; b < N; ++b) pull = hn::MulAdd(by.P[packed(a, b)], column[b], pull);
        by_step = hn::MulAdd(column[a], by.x[a], by_step);
        by_shrink = hn::NegMulAdd(column[a], pull, by_shrink);
        by_column[a] = hn::NegMulAdd(hn::Mul(splat(2.0), shrink), pull, hn::Mul(step, by.x[a]));
      }
      const V squared = hn::Mul(inverse, inverse);
      BySignal to{zero(), zero(), hn::Mul(by_step, inverse), hn::Neg(hn::Mul(by_shrink, squared))};
      to.s = hn::Mul(hn::Mul(by_shrink, squared), hn::MulSub(splat(2.0), variance, splat(1.0)));
      to.s = hn::NegMulAdd(hn::Mul(by_step, step), inverse, to.s);
      explained(i, share, square, Q, root, to, by_Q);
      // Derivatives of the signal's moments with respect to its innovation and variance.
      const V half = splat(0.5), twice = hn::Mul(splat(2.0), mean);
      to.e = hn::Sub(hn::Mul(to.mean, hn::Sub(splat(1.0), variance)), hn::Mul(by_log, step));
      to.e = hn::NegMulAdd(hn::Mul(to.variance, root), third, to.e);
      V by_s = hn::Mul(by_log, hn::Mul(hn::MulAdd(mean, mean, hn::Sub(variance, splat(1.0))), inverse));
      by_s = hn::MulAdd(to.mean, hn::Div(hn::MulAdd(twice, variance, third), root), by_s);
      by_s = hn::MulAdd(to.variance, hn::MulAdd(twice, third, hn::NegMulAdd(variance, variance, fourth)), by_s);
      to.s = hn::MulAdd(half, by_s, to.s);
      back_to_moments(i, to, by_column, by);
      by_R[packed(i, i)] += sum_of(to.s);
    }
  }

 private:
  const ModeRows& p_;
  const Sensor& sensor_;
  std::size_t r_;
  V column_[NY][N];

  HWY_INLINE V moment(std::size_t which, std::size_t i) const { return signal_moment<NY>(p_, which, i, r_); }

  /// Adjoint of C_i Q C_i' / s (share + square (M^2 + V) / s). The last factor is limited (interval_sums).
  HWY_INLINE void explained(std::size_t i, V share, V square, const V (&Q)[packed_size(N)], V root, BySignal& to,
                            V (&by_Q)[packed_size(N)]) const {
    const V second = second_moment<NY>(p_, i, r_), most = splat(largest_standardised * largest_standardised);
    const V inverse = hn::Div(splat(1.0), hn::Mul(root, root));
    const V weight = hn::Mul(hn::MulAdd(square, hn::Min(second, most), share), inverse);
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b <= a; ++b)
        by_Q[packed(a, b)] = hn::MulAdd(splat(sensor_.C[i * N + a] * sensor_.C[i * N + b]), weight, by_Q[packed(a, b)]);
    const V of_signal = hn::Mul(along_signal<N>(sensor_, i, Q), inverse);
    const V uncut = hn::IfThenElseZero(hn::Lt(second, most), hn::Mul(hn::Mul(square, of_signal), inverse));
    to.s = hn::NegMulAdd(weight, of_signal, to.s);
    to.s = hn::NegMulAdd(uncut, second, to.s);
    to.mean = hn::MulAdd(hn::Mul(splat(2.0), uncut), hn::Mul(root, moment(1, i)), to.mean);
    to.variance = hn::Add(to.variance, uncut);
  }

  /// Adjoint of column = P C_i', s = C_i column + R_ii, e = y_i - C_i x.
  HWY_INLINE void back_to_moments(std::size_t i, const BySignal& to, V (&by_column)[N], Moments<N>& by) const {
    for (std::size_t a = 0; a < N; ++a)
      by_column[a] = hn::Mul(splat(0.5), hn::MulAdd(to.s, splat(sensor_.C[i * N + a]), by_column[a]));
    for (std::size_t a = 0; a < N; ++a) {
      by.x[a] = hn::NegMulAdd(to.e, splat(sensor_.C[i * N + a]), by.x[a]);
      for (std::size_t b = 0; b <= a; ++b) {
        V& P = by.P[packed(a, b)];
        P = hn::MulAdd(by_column[a], splat(sensor_.C[i * N + b]), P);
        P = hn::MulAdd(by_column[b], splat(sensor_.C[i * N + a]), P);
      }
    }
  }
};

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
