// The Kalman step of one state and one signal. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_SCALAR_IMM_STEP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_SCALAR_IMM_STEP_INL
#undef MODEBANK_SCALAR_IMM_STEP_INL
#else
#define MODEBANK_SCALAR_IMM_STEP_INL
#endif

#include "filter/imm_lanes-inl.hpp"
#include "filter/scalar_imm_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::scalar_imm::HWY_NAMESPACE {

using namespace imm_lanes::HWY_NAMESPACE;

/// What a mode predicts from the mixed start (x, P); `offset` = B v + c.
struct Predicted {
  V mean, variance;

  HWY_INLINE Predicted(V x, V P, V F, V Q, V offset) {
    const V unbounded = hn::MulAdd(F, x, offset);
    mean = hn::Max(hn::Min(unbounded, splat(largest_mean)), splat(-largest_mean));
    variance = hn::Min(hn::MulAdd(hn::Mul(F, F), P, Q), splat(largest_variance));
  }
  /// S, positive.
  HWY_INLINE V innovation_variance(V C, V R) const {
    return hn::Max(hn::MulAdd(hn::Mul(C, C), variance, R), splat(least_variance));
  }
};

/// What the measurement makes of it.
struct Step : Predicted {
  V innovation_variance_inverse, innovation;

  HWY_INLINE Step(const Predicted& predicted, V S_inverse, V C, V y)
      : Predicted(predicted), innovation_variance_inverse(S_inverse), innovation(hn::NegMulAdd(C, mean, y)) {}
  HWY_INLINE V nis() const { return hn::Mul(hn::Mul(innovation, innovation), innovation_variance_inverse); }
  /// The estimate after the measurement, in Joseph's form.
  HWY_INLINE void correct(V C, V R, V& posterior, V& posterior_variance) const {
    const V gain = hn::Mul(hn::Mul(variance, C), innovation_variance_inverse);
    const V rest = hn::NegMulAdd(gain, C, splat(1.0));
    posterior = hn::MulAdd(gain, innovation, mean);
    posterior_variance = hn::MulAdd(hn::Mul(rest, rest), variance, hn::Mul(hn::Mul(gain, gain), R));
  }
};

/// prior * N(innovation; 0, S) without the factor exp(-least_nis / 2) / sqrt(2 pi); `root_inverse` = 1 / sqrt(S).
HWY_INLINE V weight(const Exp& exp, V prior, V nis, V least_nis, V root_inverse) {
  const V exponent = hn::Mul(splat(-0.5), hn::Sub(nis, least_nis));
  return hn::Mul(hn::Mul(prior, root_inverse), exp(exponent));
}

}  // namespace modebank::scalar_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
