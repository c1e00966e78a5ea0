#pragma once

#include "modebank/base/names.hpp"

namespace modebank {

/// Which coefficients of a mode wander. all: every one by itself. constant: the constant. gain: one factor on those of
/// all inputs, each keeping its share. The others of the last two are learned in a run, from their variance at a start.
enum class Wandering { all, constant, gain };

template <>
struct EnumNames<Wandering> {
  static constexpr Names<3> values{"all", "constant", "gain"};
};

}  // namespace modebank
