// The step that takes a measurement in, a mode per lane. Included once per instruction set (Highway's
// foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_UPDATE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_UPDATE_INL
#undef MODEBANK_VECTOR_IMM_UPDATE_INL
#else
#define MODEBANK_VECTOR_IMM_UPDATE_INL
#endif

#include "filter/vector_imm_noise-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// Probabilities after the measurement: no mode dies for good.
HWY_INLINE void floor_probabilities(const ModeRows& p, const double* weights, double scale) {
  V total = hn::Zero(D());
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D())) {
    const M there = hn::FirstN(D(), p.modes > r ? p.modes - r : 0);
    const V mu = hn::Max(hn::Mul(load(weights + r), splat(scale)), splat(mode_probability_floor));
    const V kept = hn::IfThenElseZero(there, mu);
    total = hn::Add(total, kept);
    store(kept, p.probability + r);
  }
  const V normal = splat(1.0 / sum_of(total));
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D()))
    store(hn::Mul(load(p.probability + r), normal), p.probability + r);
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
  result.log_density =
      hn::GetLane(hn::Log(D(), splat(total))) - 0.5 * (static_cast<double>(NY) * log_two_pi + hn::GetLane(nearest));
  if (noise_scale > 0.0) {
    result.share = noise_scale * sum_of(share) / total;
    result.square = noise_scale * sum_of(square) / total;
  }
  floor_probabilities(p, p.weight, 1.0 / total);
  return result;
}

template <std::size_t N>
void skip(const ModeRows& p) {
  for (std::size_t i = 0; i < N * p.stride; ++i) p.mean[i] = p.predicted_mean[i];
  for (std::size_t i = 0; i < packed_size(N) * p.stride; ++i) p.covariance[i] = p.predicted_covariance[i];
  floor_probabilities(p, p.predicted_probability, 1.0);
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
