// Update with a measurement, and filtering of whole stretches, one mode per lane. Included once per instruction set
// (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_UPDATE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_UPDATE_INL
#undef MODEBANK_VECTOR_IMM_UPDATE_INL
#else
#define MODEBANK_VECTOR_IMM_UPDATE_INL
#endif

#include "filter/step/detail/vector/correct-inl.hpp"
#include "filter/step/detail/vector/interval-inl.hpp"
#include "filter/step/detail/vector/mixing-inl.hpp"
#include "filter/step/detail/vector/predict-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// If the largest exponent is above this limit, no density is near the smallest numbers.
inline constexpr double far_exponent = -100.0;

/// Log density of a measurement. The weights sum to `sum` and are relative to the exponent `reference`.
template <std::size_t NY, class Tag>
HWY_INLINE hn::Vec<Tag> log_density(Tag d, hn::Vec<Tag> sum, hn::Vec<Tag> reference) {
  const auto constant = hn::Set(d, -0.5 * static_cast<double>(NY) * log_two_pi);
  return hn::Add(hn::MulAdd(hn::Set(d, ln_2), reference, hn::Log(d, sum)), constant);
}

/// Updates every mode with y: state, p.decorrelated, exponents (base 2, of densities) and weights (prior divided by the
/// square root of det S). `predicted` has the prediction of each register. Returns the reference of the exponents: the
/// largest exponent if it is very low, else zero. With zero, the computation need not wait for the largest exponent.
template <std::size_t N, std::size_t NY, std::size_t R, class Predicted>
HWY_INLINE V correct(const ModeRows& p, const Sensor& sensor, const double* y, const Predicted& predicted,
                     Row<R>& exponents, Row<R>& weights) {
  V largest = splat(-far);
  for_each_register<R>(p, [&](std::size_t b, std::size_t r) MODEBANK_INLINE_LAMBDA {
    const Prediction<N, NY>& q = predicted(b);
    const Correction<N, NY> c(q, y);
    const M possible = hn::Ge(q.prior, splat(impossible_probability));
    const V exponent = hn::IfThenElse(possible, hn::Mul(splat(-0.5 * log2_e), c.distance()), splat(-far));
    largest = hn::Max(largest, exponent);
    exponents.set(b, exponent);
    weights.set(b, hn::IfThenElseZero(possible, hn::Mul(q.prior, c.root_determinant_inverse())));
    if constexpr (R == 0) store_rows(c.z, p.stride, p.decorrelated + r);
    const Moments<N> posterior = c.posterior(sensor);
    store_rows(posterior.x, p.stride, p.mean + r);
    store_rows(posterior.P, p.stride, p.covariance + r);
  });
  largest = hn::MaxOfLanes(D(), largest);
  V reference = zero();
  if (HWY_UNLIKELY(hn::GetLane(largest) < far_exponent)) reference = largest;
  return reference;
}

/// Bayes' rule: the weights become the posterior up to a factor. Returns this factor, the sum of the weights.
template <std::size_t R>
HWY_INLINE double bayes(const ModeRows& p, V reference, const Row<R>& exponents, Row<R>& weights) {
  V sum = zero();
  const Exp exp;
  for_each_register<R>(p, [&](std::size_t b, std::size_t) MODEBANK_INLINE_LAMBDA {
    V density[1] = {hn::Sub(exponents.get(b), reference)};
    exp.power_of_two(density);
    const V w = hn::Mul(weights.get(b), density[0]);
    weights.set(b, w);
    sum = hn::Add(sum, w);
  });
  return sum_of(sum);
}

/// Computes p.probability from weights that sum to `sum`. The floor lets every mode recover. Also updates p.parts.
template <std::size_t N, std::size_t R>
HWY_INLINE void floor_probabilities(const ModeRows& p, double sum, Row<R>& weights) {
  const V floor = splat(mode_probability_floor * sum);
  const auto there = [&](std::size_t r)
                         MODEBANK_INLINE_LAMBDA { return hn::FirstN(D(), p.modes > r ? p.modes - r : 0); };
  M rare = hn::Lt(zero(), zero());
  for_each_register<R>(p, [&](std::size_t b, std::size_t r) MODEBANK_INLINE_LAMBDA {
    rare = hn::Or(rare, hn::And(there(r), hn::Lt(weights.get(b), floor)));
  });
  if (HWY_UNLIKELY(!hn::AllFalse(D(), rare))) {
    V total = zero();
    for_each_register<R>(p, [&](std::size_t b, std::size_t r) MODEBANK_INLINE_LAMBDA {
      weights.set(b, hn::IfThenElseZero(there(r), hn::Max(weights.get(b), floor)));
      total = hn::Add(total, weights.get(b));
    });
    sum = sum_of(total);
  }
  const V normal = splat(1.0 / sum);
  for_each_register<R>(p, [&](std::size_t b, std::size_t r) MODEBANK_INLINE_LAMBDA {
    const V mu = hn::Mul(weights.get(b), normal);
    store(mu, p.probability + r);
    weigh_parts<N>(p, r, mu);
  });
}

/// Sums for adaptive noise (see adapt_noise_scale of noise_scale.hpp), from weights that sum to `sum`.
template <std::size_t N, std::size_t NY>
HWY_NOINLINE void explain(const ModeRows& p, const Sensor& sensor, const double* y, double noise_scale, double sum,
                          UpdateResult& result) {
  V share = zero(), square = zero();
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D())) {
    const V w = load(p.weight + r);
    V share_r, square_r;
    explained<N, NY>(p, sensor, y, r, share_r, square_r);
    share = hn::MulAdd(w, share_r, share);
    square = hn::MulAdd(w, square_r, square);
  }
  result.share = noise_scale * sum_of(share) / sum;
  result.square = noise_scale * sum_of(square) / sum;
}

template <std::size_t N, std::size_t NY>
UpdateResult update(const ModeRows& p, const Sensor& sensor, const double* y, double noise_scale) {
  Row<0> exponents(p.exponent), weights(p.weight);
  const auto predicted = [&](std::size_t b) { return load_prediction<N, NY>(p, b * hn::Lanes(D())); };
  const V reference = sensor.quantum ? correct_intervals<N, NY>(p, sensor, y)
                                     : correct<N, NY>(p, sensor, y, predicted, exponents, weights);
  center_modes<N>(p);
  const double sum = bayes(p, reference, exponents, weights);
  const hn::CappedTag<double, 1> one;
  UpdateResult result;
  result.log_density = hn::GetLane(log_density<NY>(one, hn::Set(one, sum), hn::Set(one, hn::GetLane(reference))));
  if (noise_scale > 0.0) explain<N, NY>(p, sensor, y, noise_scale, sum, result);
  floor_probabilities<N>(p, sum, weights);
  return result;
}

/// One sample of a stretch: `predict` and `update` of R registers. If R = 0, any number of registers in memory.
template <std::size_t N, std::size_t NY, std::size_t R>
HWY_INLINE double step(const ModeRows& p, const Sensor& sensor, const double* v, const double* y, double& reference) {
  Row<R> exponents(p.exponent), weights(p.weight);
  V shift;
  if constexpr (R > 0) {
    Prediction<N, NY> q[R];
    predict_registers<N, NY, R>(p, sensor, 0, v, splat(1.0), q);
    shift = correct<N, NY>(
        p, sensor, y, [&](std::size_t b) -> const Prediction<N, NY>& { return q[b]; }, exponents, weights);
  } else {
    predict<N, NY>(p, sensor, v, 1.0);
    shift = correct<N, NY>(
        p, sensor, y, [&](std::size_t b) { return load_prediction<N, NY>(p, b * hn::Lanes(D())); }, exponents, weights);
  }
  reference = hn::GetLane(shift);
  center_modes<N>(p);
  const double sum = bayes(p, shift, exponents, weights);
  floor_probabilities<N>(p, sum, weights);
  return sum;
}

/// Filters a stretch of samples. Logarithms are computed for many samples at once.
template <std::size_t N, std::size_t NY, std::size_t R>
void follow_registers(const ModeRows& p, const Sensor& sensor, const CompleteSamples& stretch) {
  constexpr std::size_t block = 64;
  HWY_ALIGN double sum[block], reference[block];
  for (std::size_t first = 0; first < stretch.samples; first += block) {
    const std::size_t count = HWY_MIN(block, stretch.samples - first);
    for (std::size_t k = 0; k < count; ++k)
      sum[k] = step<N, NY, R>(p, sensor, stretch.inputs + (first + k) * p.inputs,
                              stretch.measurements + (first + k) * NY, reference[k]);
    for (std::size_t k = 0; k < count; k += hn::Lanes(D()))
      store(log_density<NY>(D(), load(sum + k), load(reference + k)), sum + k);
    for (std::size_t k = 0; k < count; ++k) stretch.log_density[first + k] = sum[k];
  }
}

template <std::size_t N, std::size_t NY>
void follow(const ModeRows& p, const Sensor& sensor, const CompleteSamples& stretch) {
  constexpr std::size_t L = hn::MaxLanes(D());
  if constexpr (L == row_multiple)
    if (p.stride == L) return follow_registers<N, NY, 1>(p, sensor, stretch);
  if constexpr (2 * L >= row_multiple && most_together<N> >= 2)
    if (p.stride == 2 * L) return follow_registers<N, NY, 2>(p, sensor, stretch);
  follow_registers<N, NY, 0>(p, sensor, stretch);
}

template <std::size_t N>
void skip(const ModeRows& p) {
  for (std::size_t i = 0; i < N * p.stride; ++i) p.mean[i] = p.predicted_mean[i];
  for (std::size_t i = 0; i < packed_size(N) * p.stride; ++i) p.covariance[i] = p.predicted_covariance[i];
  for (std::size_t i = 0; i < p.stride; ++i) p.weight[i] = p.predicted_probability[i];
  center_modes<N>(p);
  Row<0> weights(p.weight);
  floor_probabilities<N>(p, 1.0, weights);
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
