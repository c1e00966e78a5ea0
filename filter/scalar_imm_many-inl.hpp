// Many runs, a run per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_SCALAR_IMM_MANY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_SCALAR_IMM_MANY_INL
#undef MODEBANK_SCALAR_IMM_MANY_INL
#else
#define MODEBANK_SCALAR_IMM_MANY_INL
#endif

#include <utility>

#include "filter/scalar_imm_step-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::scalar_imm::HWY_NAMESPACE {

/// A number of the bank: one for all lanes, or one per lane.
template <bool Shared>
HWY_INLINE V of_bank(const double* p, std::size_t i) {
  if constexpr (Shared)
    return splat(p[i]);
  else
    return load(p + i * hn::Lanes(D()));
}

/// 1 / c of several, all at most one, by one reciprocal. Returns their product: none of them lies below it.
template <std::size_t J>
HWY_INLINE V reciprocals(const V (&c)[J], V (&inverse)[J]) {
  V product[J];
  product[0] = c[0];
  for (std::size_t b = 1; b < J; ++b) product[b] = hn::Mul(product[b - 1], c[b]);
  V of_product = reciprocal(product[J - 1]);
  for (std::size_t b = J - 1; b > 0; --b) {
    inverse[b] = hn::Mul(of_product, product[b - 1]);
    of_product = hn::Mul(of_product, c[b]);
  }
  inverse[0] = of_product;
  return product[J - 1];
}

/// Sample k of the runs of one register. Where nothing is measured, as if it were a signal that is always zero, of
/// variance one, unrelated to anything.
struct LaneSample {
  M measured;
  V C, R, y;
  const double* v;

  template <bool Shared>
  static HWY_INLINE LaneSample at(const RunLanes& p, std::size_t k) {
    const std::size_t L = hn::Lanes(D());
    const V y_or_nan = load(p.measurement + k * L);
    const M measured = hn::Lt(hn::Abs(y_or_nan), splat(largest_measurement));
    return {measured, hn::IfThenElseZero(measured, of_bank<Shared>(p.C, 0)),
            hn::IfThenElse(measured, of_bank<Shared>(p.R, 0), splat(1.0)), hn::IfThenElseZero(measured, y_or_nan),
            p.v + k * p.inputs * L};
  }
};

/// The log of a product of many factors per lane, taken now and then.
class LaneProduct {
 public:
  HWY_INLINE LaneProduct() : product_(splat(1.0)), sum_(zero()) {}
  HWY_INLINE void multiply(V factor) {
    product_ = hn::Mul(product_, factor);
    const M within = hn::And(hn::Gt(product_, splat(1e-100)), hn::Lt(product_, splat(1e100)));
    if (HWY_UNLIKELY(!hn::AllTrue(D(), within))) {
      sum_ = hn::IfThenElse(within, sum_, log());
      product_ = hn::IfThenElse(within, product_, splat(1.0));
    }
  }
  HWY_INLINE void add(V value) { sum_ = hn::Add(sum_, value); }
  HWY_INLINE V log() const { return hn::Add(sum_, hn::Log(D(), product_)); }

 private:
  V product_, sum_;
};

/// The runs of one register on their way. Means and variances are in `p.mean` and `next` in turn.
struct LaneFilter {
  const RunLanes& start;
  RunLanes p;
  double* next;
  double *prior, *nis, *root;  ///< before the measurement: probability; the innovation's distance and 1 / sqrt(S)
  double *first, *second;      ///< mu d and mu (P + d^2), d about the center: what the mixtures are sums of
  V center;                    ///< mean of all modes
  LaneProduct density;

  HWY_INLINE explicit LaneFilter(const RunLanes& lanes)
      : start(lanes), p(lanes), next(lanes.next), prior(lanes.workspace) {
    const std::size_t L = hn::Lanes(D()), rows = p.modes * L;
    nis = prior + rows;
    root = nis + rows;
    first = root + rows;
    second = first + rows;
    V sum = zero();
    for (std::size_t j = 0; j < p.modes; ++j) sum = hn::MulAdd(load(p.probability + j * L), load(p.mean + j * L), sum);
    center = sum;
    density.add(load(p.log_likelihood));
    prepare_mixing(splat(1.0), center);
  }

  /// Transition k. The parts are functions by themselves, so that each has all registers.
  template <bool Shared>
  HWY_INLINE void step(std::size_t k) {
    for (std::size_t j = 0; j < p.modes;) {
      const std::size_t rest = p.modes - j, block = rest % 4 == 0 ? 4 : rest < 3 ? rest : 3;
      if (block == 4) mix<Shared, 4>(j);
      if (block == 3) mix<Shared, 3>(j);
      if (block == 2) mix<Shared, 2>(j);
      if (block == 1) mix<Shared, 1>(j);
      j += block;
    }
    const LaneSample sample = LaneSample::at<Shared>(p, k);
    const V least = step_modes<Shared>(sample);
    weigh(sample.measured, least);
  }

  /// The modes' probabilities after the measurement and what the next step mixes.
  HWY_NOINLINE void weigh(M measured, V least) {
    const Exp exp;
    const std::size_t L = hn::Lanes(D()), K = p.modes;
    double *const w = prior, *const mu = p.probability;
    const double *const distance = nis, *const root_inverse = root, *const mean = next;
    V sum = zero();
    for (std::size_t j = 0; j < K; ++j) {
      const V of_mode = weight(exp, load(w + j * L), load(distance + j * L), least, load(root_inverse + j * L));
      store(of_mode, w + j * L);
      sum = hn::Add(sum, of_mode);
    }
    const V floor = hn::Mul(sum, splat(mode_probability_floor));
    V total = zero(), moment = zero();
    for (std::size_t j = 0; j < K; ++j) {
      const V floored = hn::Max(load(w + j * L), floor);
      store(floored, mu + j * L);
      total = hn::Add(total, floored);
      moment = hn::MulAdd(floored, load(mean + j * L), moment);
    }
    std::swap(p.mean, next);
    p.variance = p.mean + K * L;
    const V normal = reciprocal(total);
    center = hn::Mul(moment, normal);
    prepare_mixing(normal, center);
    density.multiply(hn::IfThenElse(measured, sum, splat(1.0)));
    const V exponent = hn::MulAdd(splat(-0.5), least, splat(-0.5 * log_two_pi));
    density.add(hn::IfThenElseZero(measured, exponent));
  }

  /// Leaves means and variances where they were at the start.
  HWY_INLINE void finish() const {
    store(density.log(), p.log_likelihood);
    if (p.mean == start.mean) return;
    for (std::size_t i = 0; i < 2 * p.modes * hn::Lanes(D()); i += hn::Lanes(D()))
      store(load(p.mean + i), start.mean + i);
  }

  /// The mixtures of all modes that lead to modes j .. j + J, which share what is loaded of the modes they come from:
  /// leaves their probabilities, means and variances in `prior` and `next`.
  template <bool Shared, std::size_t J>
  HWY_NOINLINE void mix(std::size_t j) {
    const std::size_t L = hn::Lanes(D()), K = p.modes;
    V c[J], x[J], P[J];
    for (std::size_t b = 0; b < J; ++b) c[b] = x[b] = P[b] = zero();
    for (std::size_t i = 0; i < K; ++i) {
      const V mu = load(p.probability + i * L), d = load(first + i * L), square = load(second + i * L);
      for (std::size_t b = 0; b < J; ++b) {
        const V T = of_bank<Shared>(p.transition, i * K + j + b);
        c[b] = hn::MulAdd(T, mu, c[b]);
        x[b] = hn::MulAdd(T, d, x[b]);
        P[b] = hn::MulAdd(T, square, P[b]);
      }
    }
    V inverse[J], surplus = splat(far);
    const V product = reciprocals(c, inverse);
    for (std::size_t b = 0; b < J; ++b) {
      const V shift = hn::Mul(x[b], inverse[b]), square = hn::Mul(P[b], inverse[b]);
      x[b] = hn::Add(center, shift);
      P[b] = hn::NegMulAdd(shift, shift, square);
      surplus = hn::Min(surplus, hn::Sub(P[b], least_sound(square, center)));
    }
    for (std::size_t b = 0; b < J; ++b) {
      store(c[b], prior + (j + b) * L);
      store(x[b], next + (j + b) * L);
      store(P[b], next + (K + j + b) * L);
    }
    // Not true where one is no number.
    const M sound = hn::And(hn::Ge(product, splat(impossible_probability)), hn::Ge(surplus, zero()));
    if (HWY_UNLIKELY(!hn::AllTrue(D(), sound)))
      for (std::size_t b = 0; b < J; ++b) mix_apart<Shared>(j + b, sound);
  }

  /// For lanes where the sums about the center do not do: an impossible mode stays where it is, of modes that differ by
  /// so much that the sums cancel the mean by itself and the variance about that.
  template <bool Shared>
  HWY_NOINLINE void mix_apart(std::size_t j, M sound) {
    const std::size_t L = hn::Lanes(D()), K = p.modes;
    double *const c = prior + j * L, *const mean = next + j * L, *const variance = next + (K + j) * L;
    const M possible = hn::Ge(load(c), splat(impossible_probability));
    const V inverse = reciprocal(hn::IfThenElse(possible, load(c), splat(1.0)));
    V x = zero(), P = zero();
    for (std::size_t i = 0; i < K; ++i) {
      const V w = hn::Mul(of_bank<Shared>(p.transition, i * K + j), load(p.probability + i * L));
      x = hn::MulAdd(w, load(p.mean + i * L), x);
    }
    x = hn::Mul(x, inverse);
    for (std::size_t i = 0; i < K; ++i) {
      const V w = hn::Mul(of_bank<Shared>(p.transition, i * K + j), load(p.probability + i * L));
      const V d = hn::Sub(load(p.mean + i * L), x);
      P = hn::MulAdd(w, hn::MulAdd(d, d, load(p.variance + i * L)), P);
    }
    x = hn::IfThenElse(possible, x, load(p.mean + j * L));
    P = hn::IfThenElse(possible, hn::Mul(P, inverse), load(p.variance + j * L));
    store(hn::IfThenElseZero(possible, load(c)), c);
    store(hn::IfThenElse(sound, load(mean), x), mean);
    store(hn::IfThenElse(sound, load(variance), P), variance);
  }

  /// Steps all modes from there: leaves distance and 1 / sqrt(S) of each in the workspace and the estimates in `next`.
  /// Returns the smallest distance.
  template <bool Shared>
  HWY_NOINLINE V step_modes(const LaneSample& sample) {
    // Copies, which the stores cannot change.
    const RunLanes bank = p;
    const LaneSample s = sample;
    const std::size_t L = hn::Lanes(D()), K = bank.modes;
    double *const mean = next, *const variance = next + K * L, *const to_nis = nis, *const to_root = root;
    const double* const from = prior;
    V least = splat(far);
    for (std::size_t j = 0; j < K; ++j) {
      const std::size_t at = j * L;
      V offset = of_bank<Shared>(bank.c, j);
      for (std::size_t i = 0; i < bank.inputs; ++i)
        offset = hn::MulAdd(of_bank<Shared>(bank.B, i * K + j), load(s.v + i * L), offset);
      const Predicted predicted(load(mean + at), load(variance + at), of_bank<Shared>(bank.F, j),
                                of_bank<Shared>(bank.Q, j), offset);
      const V root_inverse = reciprocal_root(predicted.innovation_variance(s.C, s.R));
      const Step step(predicted, hn::Mul(root_inverse, root_inverse), s.C, s.y);
      V posterior, posterior_variance;
      step.correct(s.C, s.R, posterior, posterior_variance);
      const V square = hn::IfThenElse(hn::Gt(load(from + at), zero()), step.nis(), splat(far));
      least = hn::Min(least, square);
      store(posterior, mean + at);
      store(posterior_variance, variance + at);
      store(square, to_nis + at);
      store(root_inverse, to_root + at);
    }
    return least;
  }

  /// Of unnormalised probabilities.
  HWY_INLINE void prepare_mixing(V normal, V about) {
    const std::size_t L = hn::Lanes(D()), K = p.modes;
    double *const probability = p.probability, *const to_first = first, *const to_second = second;
    const double *const mean = p.mean, *const variance = p.variance;
    for (std::size_t j = 0; j < K; ++j) {
      const V mu = hn::Mul(load(probability + j * L), normal), d = hn::Sub(load(mean + j * L), about);
      store(mu, probability + j * L);
      store(hn::Mul(mu, d), to_first + j * L);
      store(hn::Mul(mu, hn::MulAdd(d, d, load(variance + j * L))), to_second + j * L);
    }
  }
};

template <bool Shared>
void many_runs(const RunLanes& p) {
  LaneFilter filter(p);
  for (std::size_t k = 0; k < p.count; ++k) filter.step<Shared>(k);
  filter.finish();
}

}  // namespace modebank::scalar_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
