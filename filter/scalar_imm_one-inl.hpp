// One run, a mode per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_SCALAR_IMM_ONE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_SCALAR_IMM_ONE_INL
#undef MODEBANK_SCALAR_IMM_ONE_INL
#else
#define MODEBANK_SCALAR_IMM_ONE_INL
#endif

#include <cmath>

#include "filter/scalar_imm_step-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::scalar_imm::HWY_NAMESPACE {

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
  const Exp exp;
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
        c[r] = hn::IfThenElseZero(possible[r], weight(exp, c[r], nis[r], least, hn::Sqrt(inverse_S[r])));
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

}  // namespace modebank::scalar_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
