#pragma once

#include "modebank/base/names.hpp"

namespace modebank {

/// imm: Blom & Bar-Shalom (1988). mmae: no mixing. gpb1, gpb2: generalised pseudo-Bayesian of first and second order
/// (Ackerson & Fu 1970; Chang & Athans 1978; Bar-Shalom, Li & Kirubarajan 2001, sections 11.6.4 and 11.6.5): all modes
/// start from one common estimate, or each mode from each mode's own (K^2 Kalman steps, then merged). salvi2025: the
/// printed equations 12-18. kf: the Kalman filter of a bank of one mode.
enum class FilterVariant { imm, mmae, gpb1, gpb2, salvi2025, kf };

template <>
struct EnumNames<FilterVariant> {
  static constexpr Names<6> values{"imm", "mmae", "gpb1", "gpb2", "salvi2025", "kf"};
};

/// gaussian: Q as learned. adaptive: Q times a scale that follows the run (equations/noise_scale.hpp).
enum class FilterNoise { gaussian, adaptive };

template <>
struct EnumNames<FilterNoise> {
  static constexpr Names<2> values{"gaussian", "adaptive"};
};

/// How a filter treats a longer time between two samples than its bank's sample period. A bank is a discrete model: one
/// of its steps takes bank.dt_s, whatever the clock says. repeat: as many prediction steps as fit (rounded, at least
/// one), with the input held. single: one step always, as if nobody had looked at the clock.
enum class TimeSteps { repeat, single };

template <>
struct EnumNames<TimeSteps> {
  static constexpr Names<2> values{"repeat", "single"};
};

/// How a bank is stepped. Defaults are the recommended method.
struct FilterOptions {
  FilterVariant variant = FilterVariant::imm;  ///< how the modes exchange what they know
  bool parameter_noise = false;  ///< Q_k = Q + (I (x) phi') Sigma_theta (I (x) phi')' with the mode's spread
  TimeSteps time_steps = TimeSteps::repeat;   ///< what a longer time between two samples means
  FilterNoise noise = FilterNoise::gaussian;  ///< whether the scale of the noise follows the run

  /// Equal in every member.
  bool operator==(const FilterOptions&) const = default;
};

}  // namespace modebank
