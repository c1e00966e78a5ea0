// Adjoints of the kernels of vector_imm.hpp, compiled once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/step/detail/vector/reverse.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// This include must follow highway.h:
#include "filter/step/detail/vector/reverse-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {

Reverse reverse_here(std::size_t n, std::size_t n_y) {
  if (n == 1 && n_y == 1) return reverse<1, 1>;
  if (n == 2 && n_y == 1) return reverse<2, 1>;
  if (n == 2 && n_y == 2) return reverse<2, 2>;
  if (n == 3 && n_y == 1) return reverse<3, 1>;
  if (n == 3 && n_y == 3) return reverse<3, 3>;
  if (n == 4 && n_y == 1) return reverse<4, 1>;
  return nullptr;
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::vector_imm {

HWY_EXPORT(reverse_here);

Reverse reverse(std::size_t states, std::size_t measurements) {
  return HWY_DYNAMIC_DISPATCH(reverse_here)(states, measurements);
}

}  // namespace modebank::vector_imm
#endif
