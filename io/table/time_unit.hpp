#pragma once

#include "modebank/base/names.hpp"

namespace modebank {

/// What a column of times counts. automatic: told by the format, by the column's name or unit, or by how large and how
/// far apart the stamps are.
enum class TimeUnit { automatic, s, ms, us, ns };

template <>
struct EnumNames<TimeUnit> {
  static constexpr Names<5> values{"auto", "s", "ms", "us", "ns"};
};

}  // namespace modebank
