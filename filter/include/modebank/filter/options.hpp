#pragma once

#include "modebank/base/names.hpp"

namespace modebank {

/// imm: Blom & Bar-Shalom (1988). salvi2025: the printed equations 12-18. kf: the Kalman filter of a bank of one mode.
enum class FilterVariant { imm, salvi2025, kf };

template <>
struct EnumNames<FilterVariant> {
  static constexpr Names<3> values{"imm", "salvi2025", "kf"};
};

/// gaussian: Q as learned. adaptive: Q times a scale that follows how large the run's innovations are.
enum class FilterNoise { gaussian, adaptive };

template <>
struct EnumNames<FilterNoise> {
  static constexpr Names<2> values{"gaussian", "adaptive"};
};

/// How a bank is stepped. Defaults are the recommended method. A bank is a discrete model: one of its steps takes
/// bank.dt_s. A longer time between two samples is as many prediction steps as fit (rounded, at least one), with the
/// input held.
struct FilterOptions {
  FilterVariant variant = FilterVariant::imm;  ///< how the modes exchange what they know
  FilterNoise noise = FilterNoise::gaussian;   ///< whether the scale of the noise follows the run

  /// Equal in every member.
  bool operator==(const FilterOptions&) const = default;
};

}  // namespace modebank
