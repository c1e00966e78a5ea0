// Kernels for every loss and number of regressors; those of common shapes are in batch_convex.cpp and
// batch_nonconvex.cpp.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ident/batch_any.cpp"
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
MODEBANK_BATCH_KERNEL(any, 1, AnyLoss, AnyLoss)
MODEBANK_BATCH_KERNEL(any, 2, AnyLoss, AnyLoss)
MODEBANK_BATCH_KERNEL(any, 3, AnyLoss, AnyLoss)
MODEBANK_BATCH_KERNEL(any, 4, AnyLoss, AnyLoss)
MODEBANK_BATCH_KERNEL(any, 5, AnyLoss, AnyLoss)
MODEBANK_BATCH_KERNEL(any, 6, AnyLoss, AnyLoss)
MODEBANK_BATCH_KERNEL(any, 7, AnyLoss, AnyLoss)
MODEBANK_BATCH_KERNEL(any, 8, AnyLoss, AnyLoss)
#undef MODEBANK_BATCH_KERNEL

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::batch {

HWY_EXPORT(any1);
HWY_EXPORT(any2);
HWY_EXPORT(any3);
HWY_EXPORT(any4);
HWY_EXPORT(any5);
HWY_EXPORT(any6);
HWY_EXPORT(any7);
HWY_EXPORT(any8);

Kernel any_kernel(int regressors) {
  switch (regressors) {
    case 1:
      return HWY_DYNAMIC_DISPATCH(any1);
    case 2:
      return HWY_DYNAMIC_DISPATCH(any2);
    case 3:
      return HWY_DYNAMIC_DISPATCH(any3);
    case 4:
      return HWY_DYNAMIC_DISPATCH(any4);
    case 5:
      return HWY_DYNAMIC_DISPATCH(any5);
    case 6:
      return HWY_DYNAMIC_DISPATCH(any6);
    case 7:
      return HWY_DYNAMIC_DISPATCH(any7);
    case 8:
      return HWY_DYNAMIC_DISPATCH(any8);
    default:
      return nullptr;
  }
}

}  // namespace modebank::batch
#endif
