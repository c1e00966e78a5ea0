#pragma once

#include <limits>

#include "ident/data/input_clock.hpp"
#include "ident/data/streams.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// How an estimate of a lag ended. not_excited: the response fits about equally well at any lag of the range, so the
/// number means nothing; at_edge: it fits best at the end of the range searched (lags; drifts to 5 %), so the truth may
/// lie beyond.
enum class LagStatus { converged, not_excited, at_edge, not_estimated };

template <>
struct EnumNames<LagStatus> {
  static constexpr Names<4> values{"converged", "not_excited", "at_edge", "not_estimated"};
};

struct LagOptions {
  double range_s = 2.5;  ///< lags from -range_s to range_s are searched; at most a quarter of the run
};

/// The lag of one run as a dead time, its standard errors and the rest of the model it was found with.
struct LagFit {
  InputClock clock;  ///< lag at the middle of the run, and its drift (0 where it was not estimated)
  double lag_standard_error_s = std::numeric_limits<double>::quiet_NaN();
  double drift_standard_error = std::numeric_limits<double>::quiet_NaN();
  double time_constant_s = 0.0;  ///< of the response; 0: at its bound, the response is as fast as the samples show
  double r_squared = 0.0;        ///< share of the states' variance explained (n > 1: 1 - geometric mean of the rest)
  LagStatus status = LagStatus::not_estimated;

  bool usable() const { return status == LagStatus::converged; }
};

struct LagEstimate {
  LagFit constant;  ///< drift held at 0
  LagFit drifting;  ///< with linear drift
};

/// Dead time from inputs to states, lag(t) = lag + drift (t - middle), by output error: every state is regressed on the
/// inputs, held, delayed by lag(t) and passed through one first-order lag (time constant from 0 to the range, shared),
/// plus a constant; inputs share one lag. All are averaged over the longer of the two sample periods, so the fit is
/// smooth in the lag and resolves parts of a sample. Minimises the sum over states of log(1 - R^2) over the samples
/// whose delayed inputs are known, on a grid, then by pattern search, with Huber weights against outliers.
///
/// The time constant takes up what a one-step model explains by A, so the dead time is what such a model needs to have
/// removed; the delay at which the signals match best (ident/lag/track.hpp) is longer by about the time constant.
/// Standard errors: Gauss-Newton sandwich with the autocorrelation of the scores by Newey & West (1987), bandwidth by
/// Andrews (1991, eq. 6.2, 6.4). Missing states are bridged where short and left out where long; NaN inputs keep their
/// last value. Streams too short or without change give not_excited, never an exception.
LagEstimate estimate_lag(const Stream& states, const Stream& inputs, const LagOptions& options);

}  // namespace modebank
