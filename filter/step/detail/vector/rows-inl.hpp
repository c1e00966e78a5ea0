// Vectors of doubles with one mode per lane, and rows of modes stored in such vectors (kernels.hpp). Included once per
// instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_VECTOR_IMM_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_VECTOR_IMM_ROWS_INL
#undef MODEBANK_VECTOR_IMM_ROWS_INL
#else
#define MODEBANK_VECTOR_IMM_ROWS_INL
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "filter/step/detail/vector/kernels.hpp"
#include "filter/step/equations/bounds.hpp"
#include "ident/base/detail/exp-inl.hpp"
#include "ident/base/detail/simd-inl.hpp"
#include "ident/base/log_two_pi.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using batch::HWY_NAMESPACE::reciprocal;
using batch::HWY_NAMESPACE::reciprocal_root;
using em::HWY_NAMESPACE::Exp;
using em::HWY_NAMESPACE::in_register;
using em::HWY_NAMESPACE::ln_2;
using em::HWY_NAMESPACE::log2_e;

// Not wider than the padding (kernels.hpp), so that rows consist of whole registers on every machine.
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

static_assert(hn::MaxLanes(D()) <= row_multiple);

inline constexpr double far = 1e300;  ///< squared distance that marks an impossible mode

HWY_INLINE V splat(double value) { return hn::Set(D(), value); }
HWY_INLINE V zero() { return hn::Zero(D()); }
HWY_INLINE V load(const double* p) { return hn::Load(D(), p); }
HWY_INLINE void store(V v, double* p) { hn::Store(v, D(), p); }
HWY_INLINE double sum_of(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

/// Smallest variance for which the moments of a mixture may be computed from sums about another point, the center. They
/// are variance = square - shift^2 and mean = center + shift. For a smaller variance, more than ten of 53 bits are
/// lost, or the error of the mean approaches a standard deviation. Then the sums must be about the mean.
HWY_INLINE V least_sound(V square, V center) {
  constexpr double least_share = 0x1p-10, least_of_center = 0x1p-80;
  return hn::Max(hn::Mul(square, splat(least_share)), hn::Mul(hn::Mul(center, center), splat(least_of_center)));
}

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

/// Mean and covariance of one register of modes, one mode per lane.
template <std::size_t N>
struct Moments {
  V x[N];
  V P[packed_size(N)];
};

/// One number per mode, in R registers. If R = 0, the numbers of any number of modes are in memory.
template <std::size_t R>
struct Row {
  V registers[R];
  HWY_INLINE explicit Row(double*) {}
  HWY_INLINE V get(std::size_t b) const { return registers[b]; }
  HWY_INLINE void set(std::size_t b, V value) { registers[b] = value; }
};
template <>
struct Row<0> {
  double* memory;
  HWY_INLINE explicit Row(double* row) : memory(row) {}
  HWY_INLINE V get(std::size_t b) const { return load(memory + b * hn::Lanes(D())); }
  HWY_INLINE void set(std::size_t b, V value) { store(value, memory + b * hn::Lanes(D())); }
};

/// Calls visit(b, r) for every register of modes, with rows r .. r + lanes. The loop over R registers is unrolled.
template <std::size_t R, class Visit>
HWY_INLINE void for_each_register(const ModeRows& p, const Visit& visit) {
  constexpr std::size_t lanes = hn::MaxLanes(D());
  static_assert(R <= 2);
  if constexpr (R > 0) {
    visit(0, 0);
    if constexpr (R > 1) visit(1, lanes);
  } else {
    for (std::size_t b = 0; b * lanes < p.stride; ++b) visit(b, b * lanes);
  }
}
/// Inlined: a function call would spill the registers to memory.
#define MODEBANK_INLINE_LAMBDA __attribute__((always_inline))

/// P C' for a covariance P.
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
