// The normal distribution function of many arguments. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_NORMAL_CDF_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_NORMAL_CDF_INL
#undef MODEBANK_NORMAL_CDF_INL
#else
#define MODEBANK_NORMAL_CDF_INL
#endif

#include "filter/imm_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::imm_lanes::HWY_NAMESPACE {

/// (1 + 2 t) exp(t^2) erfc(t), t >= 0, as a polynomial in (t - 3.75) / (t + 3.75): Shepherd & Laframboise 1981,
/// "Chebyshev approximation of (1 + 2x) exp(x^2) erfc x", Mathematics of Computation 36(153); to double precision by
/// tests/golden/normal_cdf_coefficients.py.
inline constexpr double scaled_erfc[24] = {
    1.2375126308378275266,      -0.14024059858554701439,   0.0035854154854795751663,    0.082276738490149772563,
    -0.10880393014246644782,    0.092304321160258936107,   -0.058693398576310612527,    0.02836227742037733368,
    -0.0097465796859621716144,  0.001755625843431864142,   0.00029371439057885598056,   -0.00029015404203352703981,
    0.000051646493410028769663, 0.00002238413852565675639, -0.000011437980374495534082, -9.7338751674941428565e-7,
    1.7419011945194366247e-6,   -5.741076073013915709e-8,  -2.4851108650210706133e-7,   2.3398534313040896942e-8,
    3.1953986120578180665e-8,   -3.7981897977362071919e-9, -2.6185201565031447991e-9,   3.2052623379289157079e-10};

/// Phi(x), accurate in relative terms into the lower tail down to x = -37, whose value stands for all below.
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

}  // namespace modebank::imm_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
