// Kernels of EM on points without errors.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mixture/detail/kernels/plain.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "mixture/detail/kernels/kernels.hpp"
#include "mixture/detail/kernels/small-inl.hpp"
#include "mixture/detail/kernels/tiles-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

template <class Kernel>
Kernels kernels_of(Packing packing, int features, bool diagonal) {
  Kernels kernels;
  kernels.packing = packing;
  kernels.entries = 1 + features + (diagonal ? features : features * (features + 1) / 2);
  kernels.work = Kernel::work(features);
  kernels.evaluate = Kernel::evaluate;
  kernels.measure = measure<Kernel>;
  kernels.accumulate = Kernel::accumulate;
  return kernels;
}

Kernels plain(int features, bool diagonal) {
#define MODEBANK_EM_SMALL(F)                                                          \
  case F:                                                                             \
    return diagonal ? kernels_of<Small<F, true>>(Packing::affine, features, diagonal) \
                    : kernels_of<Small<F, false>>(Packing::affine, features, diagonal);
  switch (features) {
    MODEBANK_EM_SMALL(1)
    MODEBANK_EM_SMALL(2)
    MODEBANK_EM_SMALL(3)
    MODEBANK_EM_SMALL(4)
    default:
      return diagonal ? kernels_of<Tiles<true>>(Packing::diagonal, features, diagonal)
                      : kernels_of<Tiles<false>>(Packing::tiles, features, diagonal);
  }
#undef MODEBANK_EM_SMALL
}

void reduce(const double* lanes, Index count, double* sums) {
  for (Index i = 0; i < count; ++i) sums[i] = hn::GetLane(hn::SumOfLanes(D(), load(lanes + i * L)));
}

Index lane_count() { return L; }

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::em {

HWY_EXPORT(plain);
HWY_EXPORT(reduce);
HWY_EXPORT(lane_count);

Kernels plain_kernels(int features, bool diagonal) { return HWY_DYNAMIC_DISPATCH(plain)(features, diagonal); }
void reduce_lanes(const double* lanes, Index count, double* sums) { HWY_DYNAMIC_DISPATCH(reduce)(lanes, count, sums); }
Index lanes() { return HWY_DYNAMIC_DISPATCH(lane_count)(); }

}  // namespace modebank::em
#endif
