// Kernels of the losses that are not convex, for common shapes.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ident/batch_nonconvex.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "ident/batch_chunk-inl.hpp"
#include "ident/batch_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {

#define MODEBANK_BATCH_KERNEL(name, Q, LossT, FirstLoss)                                           \
  void name##Q(const Settings& settings, const Chunk& chunk, double* scratch, const Output& out) { \
    solve_chunk<Q, LossT, FirstLoss>(settings, chunk, scratch, out);                               \
  }
MODEBANK_BATCH_KERNEL(cauchy, 2, CauchyLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(cauchy, 3, CauchyLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(cauchy, 4, CauchyLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(tukey, 2, TukeyLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(tukey, 3, TukeyLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(tukey, 4, TukeyLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(arctan, 2, ArctanLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(arctan, 3, ArctanLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(arctan, 4, ArctanLoss, HuberLoss)
#undef MODEBANK_BATCH_KERNEL

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::batch {

HWY_EXPORT(cauchy2);
HWY_EXPORT(cauchy3);
HWY_EXPORT(cauchy4);
HWY_EXPORT(tukey2);
HWY_EXPORT(tukey3);
HWY_EXPORT(tukey4);
HWY_EXPORT(arctan2);
HWY_EXPORT(arctan3);
HWY_EXPORT(arctan4);

Kernel nonconvex_kernel(Loss loss, int regressors) {
  switch (static_cast<int>(loss) * 10 + regressors) {
    case static_cast<int>(Loss::cauchy) * 10 + 2:
      return HWY_DYNAMIC_DISPATCH(cauchy2);
    case static_cast<int>(Loss::cauchy) * 10 + 3:
      return HWY_DYNAMIC_DISPATCH(cauchy3);
    case static_cast<int>(Loss::cauchy) * 10 + 4:
      return HWY_DYNAMIC_DISPATCH(cauchy4);
    case static_cast<int>(Loss::tukey) * 10 + 2:
      return HWY_DYNAMIC_DISPATCH(tukey2);
    case static_cast<int>(Loss::tukey) * 10 + 3:
      return HWY_DYNAMIC_DISPATCH(tukey3);
    case static_cast<int>(Loss::tukey) * 10 + 4:
      return HWY_DYNAMIC_DISPATCH(tukey4);
    case static_cast<int>(Loss::arctan) * 10 + 2:
      return HWY_DYNAMIC_DISPATCH(arctan2);
    case static_cast<int>(Loss::arctan) * 10 + 3:
      return HWY_DYNAMIC_DISPATCH(arctan3);
    case static_cast<int>(Loss::arctan) * 10 + 4:
      return HWY_DYNAMIC_DISPATCH(arctan4);
    default:
      return nullptr;
  }
}

}  // namespace modebank::batch
#endif
