// Kernels of the convex losses for common shapes.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ident/batch_convex.cpp"
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
MODEBANK_BATCH_KERNEL(trivial, 2, TrivialLoss, TrivialLoss)
MODEBANK_BATCH_KERNEL(trivial, 3, TrivialLoss, TrivialLoss)
MODEBANK_BATCH_KERNEL(trivial, 4, TrivialLoss, TrivialLoss)
MODEBANK_BATCH_KERNEL(huber, 2, HuberLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(huber, 3, HuberLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(huber, 4, HuberLoss, HuberLoss)
MODEBANK_BATCH_KERNEL(softlone, 2, SoftLOneLoss, SoftLOneLoss)
MODEBANK_BATCH_KERNEL(softlone, 3, SoftLOneLoss, SoftLOneLoss)
MODEBANK_BATCH_KERNEL(softlone, 4, SoftLOneLoss, SoftLOneLoss)
#undef MODEBANK_BATCH_KERNEL

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::batch {

HWY_EXPORT(trivial2);
HWY_EXPORT(trivial3);
HWY_EXPORT(trivial4);
HWY_EXPORT(huber2);
HWY_EXPORT(huber3);
HWY_EXPORT(huber4);
HWY_EXPORT(softlone2);
HWY_EXPORT(softlone3);
HWY_EXPORT(softlone4);

Kernel convex_kernel(Loss loss, int regressors) {
  switch (static_cast<int>(loss) * 10 + regressors) {
    case static_cast<int>(Loss::trivial) * 10 + 2:
      return HWY_DYNAMIC_DISPATCH(trivial2);
    case static_cast<int>(Loss::trivial) * 10 + 3:
      return HWY_DYNAMIC_DISPATCH(trivial3);
    case static_cast<int>(Loss::trivial) * 10 + 4:
      return HWY_DYNAMIC_DISPATCH(trivial4);
    case static_cast<int>(Loss::huber) * 10 + 2:
      return HWY_DYNAMIC_DISPATCH(huber2);
    case static_cast<int>(Loss::huber) * 10 + 3:
      return HWY_DYNAMIC_DISPATCH(huber3);
    case static_cast<int>(Loss::huber) * 10 + 4:
      return HWY_DYNAMIC_DISPATCH(huber4);
    case static_cast<int>(Loss::softlone) * 10 + 2:
      return HWY_DYNAMIC_DISPATCH(softlone2);
    case static_cast<int>(Loss::softlone) * 10 + 3:
      return HWY_DYNAMIC_DISPATCH(softlone3);
    case static_cast<int>(Loss::softlone) * 10 + 4:
      return HWY_DYNAMIC_DISPATCH(softlone4);
    default:
      return nullptr;
  }
}

}  // namespace modebank::batch
#endif
