#pragma once

#include "modebank/base/names.hpp"

namespace modebank {

/// Which coefficients of a mode drift. all: each coefficient independently. constant: only the constant. gain: one
/// common factor on all input coefficients, so their ratios do not change. With constant and gain, the other
/// coefficients are learned within a run from their starting variance.
enum class Wandering { all, constant, gain };

template <>
struct EnumNames<Wandering> {
  static constexpr Names<3> values{"all", "constant", "gain"};
};

}  // namespace modebank
