// Start of the modes' predictions: for each mode the mixture of all modes that can switch to it, one mode per lane.
// Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_MIXING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_MIXING_INL
#undef MODEBANK_VECTOR_IMM_MIXING_INL
#else
#define MODEBANK_VECTOR_IMM_MIXING_INL
#endif

#include "filter/step/detail/vector/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// Stores d_i and P_i + d_i d_i' of each mode in p.parts. d_i is relative to p.center, the mean of the modes' means.
/// The stored numbers do not depend on the probabilities, which an update computes last. So this function can run
/// before the probabilities are known.
template <std::size_t N>
HWY_INLINE void center_modes(const ModeRows& p) {
  const std::size_t stride = p.stride;
  V center[N];
  for (std::size_t a = 0; a < N; ++a) {
    V sum = zero();
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) sum = hn::Add(sum, load(p.mean + a * stride + r));
    p.center[a] = sum_of(sum) * p.share;
    center[a] = splat(p.center[a]);
  }
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    V d[N];
    for (std::size_t a = 0; a < N; ++a) {
      d[a] = hn::Sub(load(p.mean + a * stride + r), center[a]);
      store(d[a], p.parts + a * stride + r);
    }
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const std::size_t k = packed(a, b);
        store(hn::MulAdd(d[a], d[b], load(p.covariance + k * stride + r)), p.parts + (N + k) * stride + r);
      }
  }
}

/// Multiplies p.parts of register r by mu_i: mu_i d_i and mu_i (P_i + d_i d_i'), the summands of the mixtures.
template <std::size_t N>
HWY_INLINE void weigh_parts(const ModeRows& p, std::size_t r, V mu) {
  for (std::size_t k = 0; k < N + packed_size(N); ++k) {
    double* part = p.parts + k * p.stride + r;
    store(hn::Mul(mu, load(part)), part);
  }
}

template <std::size_t N>
void prepare(const ModeRows& p) {
  center_modes<N>(p);
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D())) weigh_parts<N>(p, r, load(p.probability + r));
}

/// Computes the means first, then the covariances about these means. Needed if modes are so different that moments
/// about the center lose too many digits.
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

/// Start of the modes of register r: the mixture of all modes that can switch to the mode (Blom & Bar-Shalom 1988).
/// `sums`: sum of mu_i T_ij, then sum of parts_i T_ij.
template <std::size_t N>
HWY_INLINE Moments<N> mixture(const ModeRows& p, std::size_t r, const V (&sums)[1 + N + packed_size(N)]) {
  const V c = sums[0];
  const M possible = hn::Ge(c, splat(impossible_probability));
  const V inverse = hn::Div(splat(1.0), hn::IfThenElse(possible, c, splat(1.0)));
  Moments<N> m;
  V shift[N], center[N];
  for (std::size_t a = 0; a < N; ++a) {
    center[a] = splat(p.center[a]);
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
    Moments<N> apart;  // a separate array, so that m can stay in registers
    mix_apart(p, r, inverse, apart);
    m = apart;
  }
  for (std::size_t a = 0; a < N; ++a) m.x[a] = hn::IfThenElse(possible, m.x[a], load(p.mean + a * p.stride + r));
  for (std::size_t k = 0; k < packed_size(N); ++k)
    m.P[k] = hn::IfThenElse(possible, m.P[k], load(p.covariance + k * p.stride + r));
  return m;
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
