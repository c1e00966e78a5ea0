// The batch solver's kernels: one table per instruction set, by loss and number of regressors.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ident/fit/detail/batch/kernels.cpp"
#include "ident/fit/detail/batch/kernels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "ident/fit/detail/batch/chunk-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {

/// Common shapes and losses have their own kernels. For all other shapes, one kernel per shape serves all losses.
/// Kernels with one lane, which only processors without AVX2 run, also serve all losses.
template <int Q>
Kernel kernel_of(Loss loss) {
  if constexpr (Q >= 2 && Q <= 4 && HWY_TARGET != HWY_SCALAR) {
    if (loss == Loss::trivial) return &solve_chunk<Q, TrivialLoss, TrivialLoss>;
    if (loss == Loss::huber) return &solve_chunk<Q, HuberLoss, HuberLoss>;
    if (loss == Loss::cauchy) return &solve_chunk<Q, CauchyLoss, HuberLoss>;
  }
  return &solve_chunk<Q, AnyLoss, AnyLoss>;
}

Kernel choose_kernel(Loss loss, int regressors) {
  switch (regressors) {
    case 1:
      return kernel_of<1>(loss);
    case 2:
      return kernel_of<2>(loss);
    case 3:
      return kernel_of<3>(loss);
    case 4:
      return kernel_of<4>(loss);
    case 5:
      return kernel_of<5>(loss);
    case 6:
      return kernel_of<6>(loss);
    default:
      return nullptr;
  }
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::batch {

HWY_EXPORT(choose_kernel);

Kernel find_kernel(Loss loss, int regressors) { return HWY_DYNAMIC_DISPATCH(choose_kernel)(loss, regressors); }

}  // namespace modebank::batch
#endif
