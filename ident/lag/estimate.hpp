#pragma once

#include <limits>

#include "ident/data/streams.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// Status of a lag estimate. not_excited: all lags of the range fit nearly equally well, so the estimate is
/// meaningless. at_edge: the best fit lies at the end of the searched range, so the true value may lie beyond it.
enum class LagStatus { converged, not_excited, at_edge, not_estimated };

template <>
struct EnumNames<LagStatus> {
  static constexpr Names<4> values{"converged", "not_excited", "at_edge", "not_estimated"};
};

struct LagOptions {
  double range_s = 2.5;  ///< lags from -range_s to range_s are searched; the range is at most a quarter of the run
};

/// The lag of one run as a dead time, with standard errors and the response model of the fit.
struct LagFit {
  double lag_s = 0.0;
  double lag_standard_error_s = std::numeric_limits<double>::quiet_NaN();
  double time_constant_s = 0.0;  ///< time constant of the response; 0 if it is at its lower bound, because the response
                                 ///< is too fast for the samples
  double r_squared = 0.0;        ///< share of the states' variance that the fit explains (n > 1: 1 - geometric mean of
                                 ///< the unexplained shares)
  LagStatus status = LagStatus::not_estimated;
};

/// Dead time from inputs to states by output error. Every state is regressed on a constant and the inputs. The inputs
/// are held, delayed and filtered by one first-order lag (time constant from 0 to the range). All inputs share one dead
/// time. All signals are averaged over the longer sample period, so the fit is smooth in the dead time and resolves
/// fractions of a sample. The objective is the sum over states of log(1 - R^2) over the samples with known delayed
/// inputs. It is minimised on a grid, then by pattern search, with Huber weights against outliers.
///
/// The time constant replaces A of a one-step model, so this dead time is the delay to remove before such a model is
/// fitted. Standard errors come from a Gauss-Newton sandwich with the autocorrelation of the scores by Newey & West
/// (1987), bandwidth by Andrews (1991, eq. 6.2, 6.4). Short gaps of states are bridged, long gaps are skipped. NaN
/// inputs keep their last value. Streams that are too short or constant give the status not_excited instead of an
/// exception.
LagFit estimate_lag(const Stream& states, const Stream& inputs, const LagOptions& options);

}  // namespace modebank
