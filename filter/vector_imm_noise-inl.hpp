// Adaptive noise's sums, a mode per lane. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_NOISE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_NOISE_INL
#undef MODEBANK_VECTOR_IMM_NOISE_INL
#else
#define MODEBANK_VECTOR_IMM_NOISE_INL
#endif

#include "filter/vector_imm_correction-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

/// tr(S^-1 C s Q C') and e' S^-1 C s Q C' S^-1 e of the modes r .., the latter with e' S^-1 e cut (noise_scale.hpp).
template <std::size_t N, std::size_t NY>
HWY_INLINE void explained(const ModeRows& p, const Sensor& sensor, const double* y, std::size_t r, V& share,
                          V& square) {
  const Correction<N, NY> c(p, y, r);
  V Q[packed_size(N)], QCt[N * NY];
  load_rows(p.Q + r, p.stride, Q);
  times_sensor<N, NY>(Q, sensor.C, QCt);
  V CQC[NY][NY];
  for (std::size_t i = 0; i < NY; ++i)
    for (std::size_t k = 0; k < NY; ++k) {
      V sum = hn::Mul(splat(sensor.C[k * N]), QCt[i]);
      for (std::size_t a = 1; a < N; ++a) sum = hn::MulAdd(splat(sensor.C[k * N + a]), QCt[a * NY + i], sum);
      CQC[i][k] = sum;  // column i of C Q C'
    }
  V pulled[NY];
  for (std::size_t i = 0; i < NY; ++i) pulled[i] = c.e[i];
  solve<NY>(c.L, c.inverse, pulled);
  share = square = hn::Zero(D());
  for (std::size_t i = 0; i < NY; ++i) {
    V along = hn::Zero(D());
    for (std::size_t k = 0; k < NY; ++k) along = hn::MulAdd(CQC[i][k], pulled[k], along);
    square = hn::MulAdd(along, pulled[i], square);
    solve<NY>(c.L, c.inverse, CQC[i]);
    share = hn::Add(share, CQC[i][i]);
  }
  const V most = splat(largest_standardised * largest_standardised * static_cast<double>(NY)), nis = c.distance();
  square = hn::IfThenElse(hn::Gt(nis, most), hn::Mul(square, hn::Div(most, hn::Max(nis, most))), square);
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
