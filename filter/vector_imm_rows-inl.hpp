// Rows of modes in registers (vector_imm_kernels.hpp). Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_ROWS_INL
#undef MODEBANK_VECTOR_IMM_ROWS_INL
#else
#define MODEBANK_VECTOR_IMM_ROWS_INL
#endif

#include "filter/imm_lanes-inl.hpp"
#include "filter/vector_imm_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

using namespace imm_lanes::HWY_NAMESPACE;
static_assert(hn::MaxLanes(D()) <= row_multiple);

constexpr std::size_t packed(std::size_t a, std::size_t b) {
  return a >= b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a;
}
constexpr std::size_t packed_size(std::size_t n) { return n * (n + 1) / 2; }

/// Rows r .. r + lanes of a group of rows.
template <std::size_t Rows>
HWY_INLINE void load_rows(const double* p, std::size_t stride, V (&v)[Rows]) {
  for (std::size_t i = 0; i < Rows; ++i) v[i] = load(p + i * stride);
}
template <std::size_t Rows>
HWY_INLINE void store_rows(const V (&v)[Rows], std::size_t stride, double* p) {
  for (std::size_t i = 0; i < Rows; ++i) store(v[i], p + i * stride);
}

/// Mean and covariance of as many modes as a register has lanes.
template <std::size_t N>
struct Moments {
  V x[N];
  V P[packed_size(N)];
};

/// P C' of a covariance.
template <std::size_t N, std::size_t NY>
HWY_INLINE void times_sensor(const V (&P)[packed_size(N)], const double* C, V (&PCt)[N * NY]) {
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t i = 0; i < NY; ++i) {
      V sum = hn::Mul(P[packed(a, 0)], splat(C[i * N]));
      for (std::size_t b = 1; b < N; ++b) sum = hn::MulAdd(P[packed(a, b)], splat(C[i * N + b]), sum);
      PCt[a * NY + i] = sum;
    }
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
