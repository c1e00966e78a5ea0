// What the modes say together, a mode per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_MIXTURE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_MIXTURE_INL
#undef MODEBANK_VECTOR_IMM_MIXTURE_INL
#else
#define MODEBANK_VECTOR_IMM_MIXTURE_INL
#endif

#include <cmath>
#include <limits>

#include "filter/normal_cdf-inl.hpp"
#include "filter/vector_imm_rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

template <std::size_t N>
void merge(const ModeRows& p, CombinedMoments to) {
  const std::size_t stride = p.stride;
  V x[N], P[packed_size(N)];
  for (std::size_t a = 0; a < N; ++a) {
    V sum = hn::Zero(D());
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D()))
      sum = hn::MulAdd(load(p.probability + r), load(p.mean + a * stride + r), sum);
    x[a] = hn::SumOfLanes(D(), sum);
    to.mean[a] = hn::GetLane(x[a]);
  }
  for (V& sum : P) sum = hn::Zero(D());
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const V mu = load(p.probability + r);
    V d[N];
    for (std::size_t a = 0; a < N; ++a) d[a] = hn::Sub(load(p.mean + a * stride + r), x[a]);
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const std::size_t k = packed(a, b);
        P[k] = hn::MulAdd(mu, hn::MulAdd(d[a], d[b], load(p.covariance + k * stride + r)), P[k]);
      }
  }
  for (std::size_t k = 0; k < packed_size(N); ++k) to.covariance[k] = sum_of(P[k]);
}

template <std::size_t N, std::size_t NY>
void combine(const ModeRows& p, const Sensor& sensor, CombinedExpectation& to) {
  const std::size_t stride = p.stride;
  for (std::size_t a = 0; a < N; ++a) {
    V sum = hn::Zero(D());
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D()))
      sum = hn::MulAdd(load(p.predicted_probability + r), load(p.predicted_mean + a * stride + r), sum);
    to.state[a] = sum_of(sum);
  }
  V S[packed_size(NY)], spread = hn::Zero(D());
  for (V& sum : S) sum = hn::Zero(D());
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const V c = load(p.predicted_probability + r);
    V d[NY];
    for (std::size_t i = 0; i < NY; ++i) {
      d[i] = hn::Zero(D());
      for (std::size_t a = 0; a < N; ++a)
        d[i] = hn::MulAdd(splat(sensor.C[i * N + a]),
                          hn::Sub(load(p.predicted_mean + a * stride + r), splat(to.state[a])), d[i]);
      spread = hn::MulAdd(c, hn::Mul(d[i], d[i]), spread);
    }
    for (std::size_t i = 0; i < NY; ++i)
      for (std::size_t k = 0; k <= i; ++k) {
        const V own = load(p.innovation_covariance + packed(i, k) * stride + r);
        S[packed(i, k)] = hn::MulAdd(c, hn::MulAdd(d[i], d[k], own), S[packed(i, k)]);
      }
  }
  for (std::size_t k = 0; k < packed_size(NY); ++k) to.innovation_covariance[k] = sum_of(S[k]);
  to.spread = sum_of(spread);
}

/// Probability integral transform of the measurement taken in last (probability_transform of combined.hpp).
template <std::size_t NY>
void transform(const ModeRows& p, const double* y, double* pit) {
  const std::size_t stride = p.stride;
  const Exp exp;
  const double* weights = p.predicted_probability;
  for (std::size_t i = 0; i < NY; ++i) {
    if (!(std::abs(y[i]) < largest_measurement)) {
      pit[i] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    V sum = zero(), nearest = splat(far);
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
      const V w = load(weights + r), root = reciprocal_root(load(p.D + i * stride + r));
      const V z = hn::Mul(load(p.decorrelated + i * stride + r), root);
      sum = hn::MulAdd(w, normal_cdf(z), sum);
      nearest = hn::Min(nearest, hn::IfThenElse(hn::Ge(w, splat(impossible_probability)), hn::Mul(z, z), splat(far)));
    }
    const double below = sum_of(sum);
    pit[i] = below < 1.0 ? below : 1.0;  // weights sum to one up to rounding
    if (i + 1 == NY) return;
    nearest = hn::MinOfLanes(D(), nearest);
    sum = zero();
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
      const V prior = load(weights + r), root = reciprocal_root(load(p.D + i * stride + r));
      const V z = hn::Mul(load(p.decorrelated + i * stride + r), root);
      const V likelihood = hn::Mul(root, exp(hn::Mul(splat(-0.5), hn::MulSub(z, z, nearest))));
      const V w = hn::IfThenElseZero(hn::Ge(prior, splat(impossible_probability)), hn::Mul(prior, likelihood));
      sum = hn::Add(sum, w);
      store(w, p.parts + r);
    }
    const V scale = splat(1.0 / sum_of(sum));
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) store(hn::Mul(load(p.parts + r), scale), p.parts + r);
    weights = p.parts;
  }
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
