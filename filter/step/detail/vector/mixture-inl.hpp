// Combination of the modes' predictions, one mode per lane. Included once per instruction set (Highway's
// foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_MIXTURE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_MIXTURE_INL
#undef MODEBANK_VECTOR_IMM_MIXTURE_INL
#else
#define MODEBANK_VECTOR_IMM_MIXTURE_INL
#endif

#include <cmath>
#include <limits>

#include "filter/step/detail/vector/rows-inl.hpp"

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
void combine(const ModeRows& p, const Sensor& sensor, CombinedExpectation to) {
  const std::size_t stride = p.stride;
  for (std::size_t a = 0; a < N; ++a) {
    V sum = hn::Zero(D());
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D()))
      sum = hn::MulAdd(load(p.predicted_probability + r), load(p.predicted_mean + a * stride + r), sum);
    to.state[a] = sum_of(sum);
  }
  V S[packed_size(NY)];
  for (V& sum : S) sum = hn::Zero(D());
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const V c = load(p.predicted_probability + r);
    V d[NY];
    for (std::size_t i = 0; i < NY; ++i) {
      d[i] = hn::Zero(D());
      for (std::size_t a = 0; a < N; ++a)
        d[i] = hn::MulAdd(splat(sensor.C[i * N + a]),
                          hn::Sub(load(p.predicted_mean + a * stride + r), splat(to.state[a])), d[i]);
    }
    for (std::size_t i = 0; i < NY; ++i)
      for (std::size_t k = 0; k <= i; ++k) {
        const V own = load(p.innovation_covariance + packed(i, k) * stride + r);
        S[packed(i, k)] = hn::MulAdd(c, hn::MulAdd(d[i], d[k], own), S[packed(i, k)]);
      }
  }
  for (std::size_t k = 0; k < packed_size(NY); ++k) to.innovation_covariance[k] = sum_of(S[k]);
}

/// (1 + 2 t) exp(t^2) erfc(t), t >= 0, as a polynomial in (t - 3.75) / (t + 3.75). Source: Shepherd & Laframboise 1981,
/// "Chebyshev approximation of (1 + 2x) exp(x^2) erfc x", Mathematics of Computation 36(153). Coefficients in double
/// precision.
inline constexpr double scaled_erfc[24] = {
    1.2375126308378275266,      -0.14024059858554701439,   0.0035854154854795751663,    0.082276738490149772563,
    -0.10880393014246644782,    0.092304321160258936107,   -0.058693398576310612527,    0.02836227742037733368,
    -0.0097465796859621716144,  0.001755625843431864142,   0.00029371439057885598056,   -0.00029015404203352703981,
    0.000051646493410028769663, 0.00002238413852565675639, -0.000011437980374495534082, -9.7338751674941428565e-7,
    1.7419011945194366247e-6,   -5.741076073013915709e-8,  -2.4851108650210706133e-7,   2.3398534313040896942e-8,
    3.1953986120578180665e-8,   -3.7981897977362071919e-9, -2.6185201565031447991e-9,   3.2052623379289157079e-10};

/// Phi(x). The relative error is small in the lower tail down to x = -37. Smaller arguments give the value at -37.
HWY_INLINE V normal_cdf(V x) {
  const V t = hn::Min(hn::Mul(hn::Abs(x), splat(0.70710678118654752440)), splat(26.2));
  const V s = hn::Mul(hn::Sub(t, splat(3.75)), reciprocal(hn::Add(t, splat(3.75)))), s2 = hn::Mul(s, s);
  V even = splat(scaled_erfc[22]), odd = splat(scaled_erfc[23]);
  for (int k = 20; k >= 0; k -= 2) {
    even = hn::MulAdd(even, s2, splat(scaled_erfc[k]));
    odd = hn::MulAdd(odd, s2, splat(scaled_erfc[k + 1]));
  }
  const V square = hn::Mul(t, t), rest = hn::MulSub(t, t, square);
  const V gauss = Exp()(hn::Neg(square));
  const V polynomial = hn::MulAdd(odd, s, even);
  const V scale = hn::Mul(splat(0.5), reciprocal(hn::MulAdd(t, splat(2.0), splat(1.0))));
  const V tail = hn::Mul(hn::Mul(hn::NegMulAdd(gauss, rest, gauss), scale), polynomial);
  return hn::IfThenElse(hn::Lt(x, zero()), tail, hn::Sub(splat(1.0), tail));
}

/// Probability integral transform of the last measurement (see probability_transform of predicted_mixture.hpp).
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
    pit[i] = below < 1.0 ? below : 1.0;  // limits rounding errors of the sum of weights
    if (i + 1 == NY) return;
    nearest = hn::MinOfLanes(D(), nearest);
    sum = zero();
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
      const V prior = load(weights + r), root = reciprocal_root(load(p.D + i * stride + r));
      const V z = hn::Mul(load(p.decorrelated + i * stride + r), root);
      const V likelihood = hn::Mul(root, exp(hn::Mul(splat(-0.5), hn::MulSub(z, z, nearest))));
      const V w = hn::IfThenElseZero(hn::Ge(prior, splat(impossible_probability)), hn::Mul(prior, likelihood));
      sum = hn::Add(sum, w);
      store(w, p.exponent + r);
    }
    const V scale = splat(1.0 / sum_of(sum));
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D()))
      store(hn::Mul(load(p.exponent + r), scale), p.exponent + r);
    weights = p.exponent;
  }
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
