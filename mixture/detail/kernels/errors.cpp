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
Kernels error_kernels_of(Packing packing, int features) {
  Kernels kernels;
  kernels.packing = packing;
  kernels.entries = 1 + expectations(features, Kernel::diagonal);
  kernels.common_work = Kernel::work(features);
  kernels.work = expectations(features, Kernel::diagonal) * together;
  kernels.evaluate = Errors<Kernel>::evaluate;
  kernels.measure = measure<Errors<Kernel>>;
  kernels.accumulate = Errors<Kernel>::accumulate;
  return kernels;
}

template <bool diagonal>
Kernels with_errors_of(int features) {
  switch (features) {
    case 1:
      return error_kernels_of<Deconvolution<1, diagonal>>(Packing::unit_rows, features);
    case 2:
      return error_kernels_of<Deconvolution<2, diagonal>>(Packing::unit_rows, features);
    case 3:
      return error_kernels_of<Deconvolution<3, diagonal>>(Packing::unit_rows, features);
    case 4:
      return error_kernels_of<Deconvolution<4, diagonal>>(Packing::unit_rows, features);
    default:
      return error_kernels_of<Deconvolution<0, diagonal>>(Packing::unit_rows, features);
  }
}

Kernels with_errors(int features, bool diagonal) {
  return diagonal ? with_errors_of<true>(features) : with_errors_of<false>(features);
}

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::em {

HWY_EXPORT(with_errors);

Kernels error_kernels(int features, bool diagonal) { return HWY_DYNAMIC_DISPATCH(with_errors)(features, diagonal); }

}  // namespace modebank::em
#endif
