#pragma once

#include "modebank/base/names.hpp"

namespace modebank {

/// imm: Blom & Bar-Shalom (1988). salvi2025: the published equations 12-18. kf: Kalman filter of a bank of one mode.
enum class FilterVariant { imm, salvi2025, kf };

template <>
struct EnumNames<FilterVariant> {
  static constexpr Names<3> values{"imm", "salvi2025", "kf"};
};

/// How a bank is run. A bank is a discrete model with step bank.dt_s. A longer time between two samples becomes several
/// prediction steps with the input held. Their number is rounded and at least one.
struct FilterOptions {
  FilterVariant variant = FilterVariant::imm;  ///< how the modes' estimates are mixed

  /// Two objects are equal if all members are equal.
  bool operator==(const FilterOptions&) const = default;
};

}  // namespace modebank
