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

/// What a mode predicts and what the measurement makes of it.
struct Step {
  V mean, variance, innovation_variance_inverse, innovation;

  /// From the mixed start (mean, variance); `offset` = B v + c.
  HWY_INLINE Step(V start, V start_variance, V F, V Q, V offset, V C, V R, V y) {
    mean = hn::MulAdd(F, start, offset);
    mean = hn::Max(hn::Min(mean, splat(largest_mean)), splat(-largest_mean));
    variance = hn::Min(hn::MulAdd(hn::Mul(F, F), start_variance, Q), splat(largest_variance));
    const V S = hn::Max(hn::MulAdd(hn::Mul(C, C), variance, R), splat(least_variance));
    innovation_variance_inverse = hn::Div(splat(1.0), S);
    innovation = hn::NegMulAdd(C, mean, y);
  }
  HWY_INLINE V nis() const { return hn::Mul(hn::Mul(innovation, innovation), innovation_variance_inverse); }
  /// The estimate after the measurement, in Joseph's form.
  HWY_INLINE void correct(V C, V R, V& posterior, V& posterior_variance) const {
    const V gain = hn::Mul(hn::Mul(variance, C), innovation_variance_inverse);
    const V rest = hn::NegMulAdd(gain, C, splat(1.0));
    posterior = hn::MulAdd(gain, innovation, mean);
    posterior_variance = hn::MulAdd(hn::Mul(rest, rest), variance, hn::Mul(hn::Mul(gain, gain), R));
  }
};

/// prior * N(innovation; 0, S) without the factor exp(-least_nis / 2) / sqrt(2 pi).
HWY_INLINE V weight(V prior, V nis, V least_nis, V inverse) {
  const V exponent = hn::Mul(splat(-0.5), hn::Sub(nis, least_nis));
  return hn::Mul(hn::Mul(prior, hn::Sqrt(inverse)), hn::Exp(D(), exponent));
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
      const Step step(mean[r], variance[r], load(p.F + r * L), load(p.Q + r * L), offset, C, R, y);
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
        c[r] = hn::IfThenElseZero(possible[r], weight(c[r], nis[r], least, inverse_S[r]));
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

/// As many runs as there are lanes.
void many_runs(const RunLanes& p) {
  const std::size_t L = hn::Lanes(D()), K = p.modes;
  double *prior = p.workspace, *mean = prior + K * L, *variance = mean + K * L, *nis = variance + K * L,
         *root = nis + K * L;
  const V C = load(p.C), R = load(p.R), impossible = splat(impossible_probability), far = splat(1e300);
  V result = hn::Zero(D());
  for (std::size_t k = 1; k < p.count; ++k) {
    const V y_or_nan = load(p.measurement + k * L);
    const M measured = hn::Lt(hn::Abs(y_or_nan), splat(largest_measurement));
    const V y = hn::IfThenElseZero(measured, y_or_nan);
    V least = far;
    for (std::size_t j = 0; j < K; ++j) {
      V c = hn::Zero(D()), x = c, P = c;
      for (std::size_t i = 0; i < K; ++i) {
        const V w = hn::Mul(load(p.transition + (i * K + j) * L), load(p.probability + i * L));
        c = hn::Add(c, w);
        x = hn::MulAdd(w, load(p.mean + i * L), x);
      }
      const M possible = hn::Ge(c, impossible);
      const V inverse = hn::Div(splat(1.0), hn::IfThenElse(possible, c, splat(1.0)));
      x = hn::IfThenElse(possible, hn::Mul(x, inverse), load(p.mean + j * L));
      for (std::size_t i = 0; i < K; ++i) {
        const V w = hn::Mul(load(p.transition + (i * K + j) * L), load(p.probability + i * L));
        const V d = hn::Sub(load(p.mean + i * L), x);
        P = hn::MulAdd(w, hn::MulAdd(d, d, load(p.variance + i * L)), P);
      }
      P = hn::IfThenElse(possible, hn::Mul(P, inverse), load(p.variance + j * L));
      V offset = load(p.c + j * L);
      for (std::size_t i = 0; i < p.inputs; ++i)
        offset = hn::MulAdd(load(p.B + (i * K + j) * L), load(p.v + ((k - 1) * p.inputs + i) * L), offset);
      const Step step(x, P, load(p.F + j * L), load(p.Q + j * L), offset, C, R, y);
      V posterior, posterior_variance;
      step.correct(C, R, posterior, posterior_variance);
      store(hn::IfThenElse(measured, posterior, step.mean), mean + j * L);
      store(hn::IfThenElse(measured, posterior_variance, step.variance), variance + j * L);
      const V square = hn::IfThenElse(possible, step.nis(), far);
      least = hn::Min(least, square);
      store(c, prior + j * L);
      store(square, nis + j * L);
      store(step.innovation_variance_inverse, root + j * L);
    }
    V sum = hn::Zero(D());
    for (std::size_t j = 0; j < K; ++j) {
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
    for (std::size_t j = 0; j < K; ++j) {
      const V mu = hn::Max(hn::Mul(load(prior + j * L), scale), splat(mode_probability_floor));
      store(mu, p.probability + j * L);
      total = hn::Add(total, mu);
    }
    const V normal = hn::Div(splat(1.0), total);
    for (std::size_t j = 0; j < K; ++j) {
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
