// Kernels of EM on points with error covariances.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mixture/em_errors.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "mixture/em_errors-inl.hpp"
#include "mixture/em_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

template <int F>
void set_kernels(Kernels& kernels) {
  kernels.evaluate = Errors<F>::evaluate;
  kernels.accumulate = Errors<F>::accumulate;
}

Kernels with_errors(int features) {
  Kernels kernels;
  kernels.packing = Packing::rows;
  kernels.entries = 1 + features + triangle(features);
  kernels.common_work = error_work(features);
  kernels.work = (features + triangle(features)) * block_size;
  switch (features) {
    case 1:
      set_kernels<1>(kernels);
      break;
    case 2:
      set_kernels<2>(kernels);
      break;
    case 3:
      set_kernels<3>(kernels);
      break;
    case 4:
      set_kernels<4>(kernels);
      break;
    default:
      set_kernels<0>(kernels);
  }
  return kernels;
}

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::em {

HWY_EXPORT(with_errors);

Kernels error_kernels(int features) { return HWY_DYNAMIC_DISPATCH(with_errors)(features); }

}  // namespace modebank::em
#endif
