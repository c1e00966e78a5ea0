// Vectors of doubles as the filter's kernels use them. Included once per instruction set (Highway's foreach_target.h).
#if defined(MODEBANK_IMM_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_IMM_LANES_INL
#undef MODEBANK_IMM_LANES_INL
#else
#define MODEBANK_IMM_LANES_INL
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "filter/bounds.hpp"
#include "ident/batch_lanes-inl.hpp"
#include "mixture/em_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::imm_lanes::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using batch::HWY_NAMESPACE::reciprocal;
using batch::HWY_NAMESPACE::reciprocal_root;
using em::HWY_NAMESPACE::Exp;

// At most the padding's width (vector_imm_kernels.hpp), so that rows are whole registers everywhere.
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

inline constexpr double log_two_pi = 1.8378770664093454836;
inline constexpr double far = 1e300;  ///< the squared distance of an impossible mode

HWY_INLINE V splat(double value) { return hn::Set(D(), value); }
HWY_INLINE V zero() { return hn::Zero(D()); }
HWY_INLINE V load(const double* p) { return hn::Load(D(), p); }
HWY_INLINE void store(V v, double* p) { hn::Store(v, D(), p); }
HWY_INLINE double sum_of(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

/// The moments of a mixture come from sums about another point, the center: variance = square - shift^2, mean = center
/// + shift. Below this variance too many bits have cancelled (more than ten of the variance's 53, or the mean's error
/// is no longer far below a standard deviation), and the sums have to be taken about the mean.
HWY_INLINE V least_sound(V square, V center) {
  constexpr double least_share = 0x1p-10, least_of_center = 0x1p-80;
  return hn::Max(hn::Mul(square, splat(least_share)), hn::Mul(hn::Mul(center, center), splat(least_of_center)));
}

}  // namespace modebank::imm_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
