// The steps of scalar_imm.hpp, once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/scalar_imm_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After highway.h:
#include <hwy/contrib/math/math-inl.h>

#include <cmath>

#include "filter/bounds.hpp"
#include "filter/scalar_imm_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::scalar_imm::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

constexpr double log_two_pi = 1.8378770664093454836;

HWY_INLINE V splat(double value) { return hn::Set(D(), value); }
HWY_INLINE V load(const double* p) { return hn::Load(D(), p); }
HWY_INLINE void store(V v, double* p) { hn::Store(v, D(), p); }

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
HWY_INLINE V weight(V prior, V nis, V least_nis, V root_inverse) {
  const V exponent = hn::Mul(splat(-0.5), hn::Sub(nis, least_nis));
  return hn::Mul(hn::Mul(prior, root_inverse), hn::Exp(D(), exponent));
}

/// A log of a product of many factors, taken now and then.
class LogProduct {
 public:
  void multiply(double factor) {
    product_ *= factor;
    if (!(product_ > 1e-100 && product_ < 1e100)) {
      sum_ += std::log(product_);
      product_ = 1.0;
    }
  }
  void add(double value) { sum_ += value; }
  double value() const { return sum_ + std::log(product_); }

 private:
  double product_ = 1.0, sum_ = 0.0;
};

/// One run; NV registers hold all modes.
template <std::size_t NV>
double one_run(const ModeLanes& p) {
  const std::size_t L = hn::Lanes(D());
  const V C = splat(p.C), R = splat(p.R), impossible = splat(impossible_probability);
  LogProduct result;
  for (std::size_t k = 1; k < p.count; ++k) {
    V c[NV], mean[NV], variance[NV];
    for (std::size_t r = 0; r < NV; ++r) c[r] = mean[r] = variance[r] = hn::Zero(D());
    for (std::size_t i = 0; i < p.modes; ++i) {
      const V mu = splat(p.probability[i]), x = splat(p.mean[i]);
      for (std::size_t r = 0; r < NV; ++r) {
        const V w = hn::Mul(load(p.transition + i * p.stride + r * L), mu);
        c[r] = hn::Add(c[r], w);
        mean[r] = hn::MulAdd(w, x, mean[r]);
      }
    }
    M possible[NV];
    V inverse[NV];
    for (std::size_t r = 0; r < NV; ++r) {
      possible[r] = hn::Ge(c[r], impossible);
      inverse[r] = hn::Div(splat(1.0), hn::IfThenElse(possible[r], c[r], splat(1.0)));
      mean[r] = hn::IfThenElse(possible[r], hn::Mul(mean[r], inverse[r]), load(p.mean + r * L));
    }
    for (std::size_t i = 0; i < p.modes; ++i) {
      const V mu = splat(p.probability[i]), x = splat(p.mean[i]), P = splat(p.variance[i]);
      for (std::size_t r = 0; r < NV; ++r) {
        const V d = hn::Sub(x, mean[r]), w = hn::Mul(load(p.transition + i * p.stride + r * L), mu);
        variance[r] = hn::MulAdd(w, hn::MulAdd(d, d, P), variance[r]);
      }
    }
    const double* v = p.v + (k - 1) * p.inputs;
    const bool measured = std::abs(p.measurement[k]) < largest_measurement;
    const V y = splat(measured ? p.measurement[k] : 0.0);
    V nis[NV], inverse_S[NV], posterior[NV], posterior_variance[NV];
    V least = splat(1e300);
    for (std::size_t r = 0; r < NV; ++r) {
      variance[r] = hn::IfThenElse(possible[r], hn::Mul(variance[r], inverse[r]), load(p.variance + r * L));
      V offset = load(p.c + r * L);
      for (std::size_t i = 0; i < p.inputs; ++i)
        offset = hn::MulAdd(load(p.B + i * p.stride + r * L), splat(v[i]), offset);
      const Predicted predicted(mean[r], variance[r], load(p.F + r * L), load(p.Q + r * L), offset);
      const Step step(predicted, hn::Div(splat(1.0), predicted.innovation_variance(C, R)), C, y);
      nis[r] = step.nis();
      inverse_S[r] = step.innovation_variance_inverse;
      least = hn::Min(least, hn::IfThenElse(possible[r], nis[r], splat(1e300)));
      if (measured) {
        step.correct(C, R, posterior[r], posterior_variance[r]);
      } else {
        posterior[r] = step.mean;
        posterior_variance[r] = step.variance;
      }
    }
    if (measured) {
      least = hn::MinOfLanes(D(), least);
      V sum = hn::Zero(D());
      for (std::size_t r = 0; r < NV; ++r) {
        c[r] = hn::IfThenElseZero(possible[r], weight(c[r], nis[r], least, hn::Sqrt(inverse_S[r])));
        sum = hn::Add(sum, c[r]);
      }
      sum = hn::SumOfLanes(D(), sum);
      result.multiply(hn::GetLane(sum));
      result.add(-0.5 * (log_two_pi + hn::GetLane(least)));
      const V scale = hn::Div(splat(1.0), sum);
      for (std::size_t r = 0; r < NV; ++r) c[r] = hn::Mul(c[r], scale);
    }
    V total = hn::Zero(D());
    for (std::size_t r = 0; r < NV; ++r) {
      const M there = hn::FirstN(D(), p.modes > r * L ? p.modes - r * L : 0);
      c[r] = hn::IfThenElseZero(there, hn::Max(c[r], splat(mode_probability_floor)));
      total = hn::Add(total, c[r]);
    }
    const V scale = hn::Div(splat(1.0), hn::SumOfLanes(D(), total));
    for (std::size_t r = 0; r < NV; ++r) {
      store(hn::Mul(c[r], scale), p.probability + r * L);
      store(posterior[r], p.mean + r * L);
      store(posterior_variance[r], p.variance + r * L);
    }
  }
  return result.value();
}

double one_run_1(const ModeLanes& p) { return one_run<1>(p); }
double one_run_2(const ModeLanes& p) { return one_run<2>(p); }
double one_run_3(const ModeLanes& p) { return one_run<3>(p); }
double one_run_4(const ModeLanes& p) { return one_run<4>(p); }
double one_run_5(const ModeLanes& p) { return one_run<5>(p); }
double one_run_6(const ModeLanes& p) { return one_run<6>(p); }
double one_run_7(const ModeLanes& p) { return one_run<7>(p); }
std::size_t lanes_here() { return hn::Lanes(D()); }

/// 1 / x of positive normal numbers to rounding: a guess from the bits (Blinn 1997), then steps that cube its error.
/// Runs in lanes wait for throughput, not for latency, and a division takes as long as sixteen of these operations.
HWY_INLINE V reciprocal(V x) {
  const hn::RebindToUnsigned<D> bits;
  V y = hn::BitCast(D(), hn::Sub(hn::Set(bits, 0x7FDE623822FC16E6ull), hn::BitCast(bits, x)));
  for (int i = 0; i < 3; ++i) {
    const V h = hn::NegMulAdd(x, y, splat(1.0));
    y = hn::MulAdd(hn::Mul(y, h), hn::Add(h, splat(1.0)), y);
  }
  return y;
}

/// 1 / sqrt(x), likewise.
HWY_INLINE V reciprocal_root(V x) {
  const hn::RebindToUnsigned<D> bits;
  const auto half = hn::ShiftRight<1>(hn::BitCast(bits, x));
  V y = hn::BitCast(D(), hn::Sub(hn::Set(bits, 0x5FE6EB50C7B537A9ull), half));
  for (int i = 0; i < 3; ++i) {
    const V h = hn::NegMulAdd(x, hn::Mul(y, y), splat(1.0));
    y = hn::MulAdd(hn::Mul(y, h), hn::MulAdd(h, splat(0.375), splat(0.5)), y);
  }
  return y;
}

/// Sample k of many runs, as their modes share it.
struct LaneSample {
  V C, R, y;
  M measured;
  const double* v;
};

/// Steps modes j .. j + J of every lane: they share what is loaded of the modes they come from. Leaves prior, distance
/// and 1 / sqrt(S) of each in the workspace, the estimates beside them; lowers `least` to the smallest distance.
template <std::size_t J>
HWY_INLINE void step_modes(const RunLanes& p, const LaneSample& sample, std::size_t j, V& least) {
  const std::size_t L = hn::Lanes(D()), K = p.modes;
  double *prior = p.workspace, *mean = prior + K * L, *variance = mean + K * L, *nis = variance + K * L,
         *root = nis + K * L;
  V c[J], x[J], P[J];
  for (std::size_t b = 0; b < J; ++b) c[b] = x[b] = P[b] = hn::Zero(D());
  for (std::size_t i = 0; i < K; ++i) {
    const V mu = load(p.probability + i * L), moved = hn::Mul(mu, load(p.mean + i * L));
    for (std::size_t b = 0; b < J; ++b) {
      const V T = load(p.transition + (i * K + j + b) * L);
      c[b] = hn::MulAdd(T, mu, c[b]);
      x[b] = hn::MulAdd(T, moved, x[b]);
    }
  }
  M possible[J];
  V inverse[J];
  for (std::size_t b = 0; b < J; ++b) {
    possible[b] = hn::Ge(c[b], splat(impossible_probability));
    inverse[b] = reciprocal(hn::IfThenElse(possible[b], c[b], splat(1.0)));
    x[b] = hn::IfThenElse(possible[b], hn::Mul(x[b], inverse[b]), load(p.mean + (j + b) * L));
  }
  for (std::size_t i = 0; i < K; ++i) {
    const V mu = load(p.probability + i * L), m = load(p.mean + i * L), own = load(p.variance + i * L);
    for (std::size_t b = 0; b < J; ++b) {
      const V w = hn::Mul(load(p.transition + (i * K + j + b) * L), mu), d = hn::Sub(m, x[b]);
      P[b] = hn::MulAdd(w, hn::MulAdd(d, d, own), P[b]);
    }
  }
  for (std::size_t b = 0; b < J; ++b) {
    const std::size_t at = (j + b) * L;
    P[b] = hn::IfThenElse(possible[b], hn::Mul(P[b], inverse[b]), load(p.variance + at));
    V offset = load(p.c + at);
    for (std::size_t i = 0; i < p.inputs; ++i)
      offset = hn::MulAdd(load(p.B + (i * K + j + b) * L), load(sample.v + i * L), offset);
    const Predicted predicted(x[b], P[b], load(p.F + at), load(p.Q + at), offset);
    const V root_inverse = reciprocal_root(predicted.innovation_variance(sample.C, sample.R));
    const Step step(predicted, hn::Mul(root_inverse, root_inverse), sample.C, sample.y);
    V posterior, posterior_variance;
    step.correct(sample.C, sample.R, posterior, posterior_variance);
    store(hn::IfThenElse(sample.measured, posterior, step.mean), mean + at);
    store(hn::IfThenElse(sample.measured, posterior_variance, step.variance), variance + at);
    const V square = hn::IfThenElse(possible[b], step.nis(), splat(1e300));
    least = hn::Min(least, square);
    store(c[b], prior + at);
    store(square, nis + at);
    store(root_inverse, root + at);
  }
}

/// As many runs as there are lanes.
void many_runs(const RunLanes& p) {
  const std::size_t L = hn::Lanes(D()), K = p.modes;
  double *prior = p.workspace, *mean = prior + K * L, *variance = mean + K * L, *nis = variance + K * L,
         *root = nis + K * L;
  const V impossible = splat(impossible_probability);
  V result = hn::Zero(D());
  for (std::size_t k = 1; k < p.count; ++k) {
    const V y_or_nan = load(p.measurement + k * L);
    const M measured = hn::Lt(hn::Abs(y_or_nan), splat(largest_measurement));
    const LaneSample sample{load(p.C), load(p.R), hn::IfThenElseZero(measured, y_or_nan), measured,
                            p.v + (k - 1) * p.inputs * L};
    V least = splat(1e300);
    std::size_t j = 0;
    for (; j + 4 <= K; j += 4) step_modes<4>(p, sample, j, least);
    for (; j + 2 <= K; j += 2) step_modes<2>(p, sample, j, least);
    if (j < K) step_modes<1>(p, sample, j, least);
    V sum = hn::Zero(D());
    for (j = 0; j < K; ++j) {
      const V c = load(prior + j * L);
      V w = weight(c, load(nis + j * L), least, load(root + j * L));
      w = hn::IfThenElseZero(hn::Ge(c, impossible), w);
      w = hn::IfThenElse(measured, w, c);
      store(w, prior + j * L);
      sum = hn::Add(sum, w);
    }
    const V log_density = hn::Sub(hn::Log(D(), sum), hn::Mul(splat(0.5), hn::Add(splat(log_two_pi), least)));
    result = hn::Add(result, hn::IfThenElseZero(measured, log_density));
    const V scale = hn::Div(splat(1.0), sum);
    V total = hn::Zero(D());
    for (j = 0; j < K; ++j) {
      const V mu = hn::Max(hn::Mul(load(prior + j * L), scale), splat(mode_probability_floor));
      store(mu, p.probability + j * L);
      total = hn::Add(total, mu);
    }
    const V normal = hn::Div(splat(1.0), total);
    for (j = 0; j < K; ++j) {
      store(hn::Mul(load(p.probability + j * L), normal), p.probability + j * L);
      store(load(mean + j * L), p.mean + j * L);
      store(load(variance + j * L), p.variance + j * L);
    }
  }
  store(result, p.log_likelihood);
}

}  // namespace modebank::scalar_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::scalar_imm {

HWY_EXPORT(one_run_1);
HWY_EXPORT(one_run_2);
HWY_EXPORT(one_run_3);
HWY_EXPORT(one_run_4);
HWY_EXPORT(one_run_5);
HWY_EXPORT(one_run_6);
HWY_EXPORT(one_run_7);
HWY_EXPORT(many_runs);
HWY_EXPORT(lanes_here);

std::size_t lane_count() { return HWY_DYNAMIC_DISPATCH(lanes_here)(); }

ModeKernel mode_kernel(std::size_t modes) {
  switch ((modes + lane_count() - 1) / lane_count()) {
    case 1:
      return HWY_DYNAMIC_DISPATCH(one_run_1);
    case 2:
      return HWY_DYNAMIC_DISPATCH(one_run_2);
    case 3:
      return HWY_DYNAMIC_DISPATCH(one_run_3);
    case 4:
      return HWY_DYNAMIC_DISPATCH(one_run_4);
    case 5:
      return HWY_DYNAMIC_DISPATCH(one_run_5);
    case 6:
      return HWY_DYNAMIC_DISPATCH(one_run_6);
    case 7:
      return HWY_DYNAMIC_DISPATCH(one_run_7);
    default:
      return nullptr;
  }
}

void run_lanes(const RunLanes& lanes) { HWY_DYNAMIC_DISPATCH(many_runs)(lanes); }

}  // namespace modebank::scalar_imm
#endif
