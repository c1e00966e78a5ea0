// Kernels of EM on points with error covariances.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mixture/detail/kernels/errors.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "mixture/detail/kernels/deconvolve-inl.hpp"
#include "mixture/detail/kernels/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

template <class Kernel>
Kernels error_kernels_of(int features) {
  Kernels kernels;
  kernels.packing = Packing::unit_rows;
  kernels.entries = 1 + expectations(features, Kernel::diagonal);
  kernels.common_work = Kernel::Work::doubles(features);
  kernels.work = expectations(features, Kernel::diagonal) * together;
  kernels.evaluate = Errors<Kernel>::evaluate;
  kernels.measure = measure<Errors<Kernel>>;
  kernels.accumulate = Errors<Kernel>::accumulate;
  return kernels;
}

Kernels with_errors(int features, bool diagonal) {
  return diagonal ? error_kernels_of<Deconvolution<true>>(features) : error_kernels_of<Deconvolution<false>>(features);
}

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::em {

HWY_EXPORT(with_errors);

Kernels error_kernels(int features, bool diagonal) { return HWY_DYNAMIC_DISPATCH(with_errors)(features, diagonal); }

}  // namespace modebank::em
#endif
