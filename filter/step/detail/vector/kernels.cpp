// The kernels of vector_imm.hpp, compiled once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/step/detail/vector/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// This include must follow highway.h:
#include "filter/step/detail/vector/mixture-inl.hpp"
#include "filter/step/detail/vector/update-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

template <std::size_t N, std::size_t NY>
Kernels kernels_of() {
  return {prepare<N>, predict<N, NY>, expect<N, NY>,  update<N, NY>, follow<N, NY>,
          skip<N>,    merge<N>,       combine<N, NY>, transform<NY>};
}

Kernels kernels_here(std::size_t n, std::size_t n_y) {
  if (n == 1 && n_y == 1) return kernels_of<1, 1>();
  if (n == 2 && n_y == 1) return kernels_of<2, 1>();
  if (n == 2 && n_y == 2) return kernels_of<2, 2>();
  if (n == 3 && n_y == 1) return kernels_of<3, 1>();
  if (n == 3 && n_y == 3) return kernels_of<3, 3>();
  if (n == 4 && n_y == 1) return kernels_of<4, 1>();
  return {};
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::vector_imm {

HWY_EXPORT(kernels_here);

Kernels kernels(std::size_t states, std::size_t measurements) {
  return HWY_DYNAMIC_DISPATCH(kernels_here)(states, measurements);
}

}  // namespace modebank::vector_imm
#endif
