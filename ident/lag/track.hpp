#pragma once

#include <Eigen/Core>

#include "ident/data/streams.hpp"

namespace modebank {

/// Delays of best match along a run, one per window in which states and inputs correlate well.
struct LagTrack {
  Eigen::VectorXd time_s;       ///< W, middle of the window
  Eigen::VectorXd lag_s;        ///< W, lag to add to the inputs' times
  Eigen::VectorXd correlation;  ///< W, correlation at that lag

  Eigen::Index windows() const { return time_s.size(); }
  double median_s() const;   ///< median lag; NaN without windows
  double least_s() const;    ///< smallest lag; NaN without windows
  double largest_s() const;  ///< largest lag; NaN without windows
};

struct LagTrackOptions {
  double range_s = 2.5;      ///< largest lag that is searched
  double window_s = 15.0;    ///< window length; windows overlap by half, and a shorter run is one window
  double correlation = 0.9;  ///< smallest correlation of a usable window
};

/// Estimates the lag in each window. If this lag is added to the inputs' times, the states (averaged over one input
/// period) correlate best with B u. B comes from the whole run at its best lag. For n > 1 the score is the mean of
/// squared correlations. The grid has steps of range_s / 100, refined by a parabola. Windows whose best lag lies at the
/// end of the range are dropped. The estimate uses no model of the dynamics. So it includes the time constant of the
/// motion, and half an input period for held inputs.
///
/// This is the only estimate of a lag that varies inside a run. On BorealTC it finds the ranges that the description of
/// the data states (FLOORING 03: 0.4 to 1.9 s; tests/app/cli/check/check_real_test.cpp). One lag and a drift per run
/// give only an average.
LagTrack track_lag(const Stream& states, const Stream& inputs, const LagTrackOptions& options = {});

}  // namespace modebank
