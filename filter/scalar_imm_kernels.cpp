// The steps of scalar_imm.hpp, once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/scalar_imm_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After highway.h:
#include "filter/scalar_imm_many-inl.hpp"
#include "filter/scalar_imm_one-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::scalar_imm::HWY_NAMESPACE {

double one_run_1(const ModeLanes& p) { return one_run<1>(p); }
double one_run_2(const ModeLanes& p) { return one_run<2>(p); }
double one_run_3(const ModeLanes& p) { return one_run<3>(p); }
double one_run_4(const ModeLanes& p) { return one_run<4>(p); }
double one_run_5(const ModeLanes& p) { return one_run<5>(p); }
double one_run_6(const ModeLanes& p) { return one_run<6>(p); }
double one_run_7(const ModeLanes& p) { return one_run<7>(p); }
std::size_t lanes_here() { return hn::Lanes(D()); }
void many(const RunLanes& p) { p.shared_bank ? many_runs<true>(p) : many_runs<false>(p); }

}  // namespace modebank::scalar_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::scalar_imm {

HWY_EXPORT(one_run_1);
HWY_EXPORT(one_run_2);
HWY_EXPORT(one_run_3);
HWY_EXPORT(one_run_4);
HWY_EXPORT(one_run_5);
HWY_EXPORT(one_run_6);
HWY_EXPORT(one_run_7);
HWY_EXPORT(many);
HWY_EXPORT(lanes_here);

std::size_t lane_count() { return HWY_DYNAMIC_DISPATCH(lanes_here)(); }

ModeKernel mode_kernel(std::size_t modes) {
  switch ((modes + lane_count() - 1) / lane_count()) {
    case 1:
      return HWY_DYNAMIC_DISPATCH(one_run_1);
    case 2:
      return HWY_DYNAMIC_DISPATCH(one_run_2);
    case 3:
      return HWY_DYNAMIC_DISPATCH(one_run_3);
    case 4:
      return HWY_DYNAMIC_DISPATCH(one_run_4);
    case 5:
      return HWY_DYNAMIC_DISPATCH(one_run_5);
    case 6:
      return HWY_DYNAMIC_DISPATCH(one_run_6);
    case 7:
      return HWY_DYNAMIC_DISPATCH(one_run_7);
    default:
      return nullptr;
  }
}

void run_lanes(const RunLanes& lanes) { HWY_DYNAMIC_DISPATCH(many)(lanes); }

}  // namespace modebank::scalar_imm
#endif
