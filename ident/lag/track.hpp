#pragma once

#include <Eigen/Core>

#include "ident/data/streams.hpp"

namespace modebank {

/// Delays of best match along a run, one per window in which states and inputs agree well.
struct LagTrack {
  Eigen::VectorXd time_s;       ///< W, middle of the window
  Eigen::VectorXd lag_s;        ///< W, to be added to the inputs' times
  Eigen::VectorXd correlation;  ///< W, correlation there

  Eigen::Index windows() const { return time_s.size(); }
  double median_s() const;   ///< NaN for no window
  double least_s() const;    ///< NaN for no window
  double largest_s() const;  ///< NaN for no window
};

struct LagTrackOptions {
  double range_s = 2.5;      ///< lags searched
  double window_s = 15.0;    ///< windows of this length overlap by half; a shorter run is one window
  double correlation = 0.9;  ///< least correlation of a window that counts
};

/// In each window: the lag that, added to the inputs' times, makes the states (averaged over one input period)
/// correlate best with B u, where B comes from the run as a whole at its best lag (n > 1: mean of squared
/// correlations); on a grid of range_s / 100, refined by a parabola. No dynamics is modelled, so the time constant of
/// the motion is part of this delay; so is half an input period where the inputs are held. Windows whose best lag is at
/// the end of the range do not count.
///
/// Worth its place because no other estimate sees a lag that wanders inside a run: on BorealTC it finds the spans that
/// the data's own description states (FLOORING 03: 0.4 to 1.9 s; tests/app/cli/check/check_real_test.cpp), where one
/// lag and a drift per run see an average.
LagTrack track_lag(const Stream& states, const Stream& inputs, const LagTrackOptions& options = {});

}  // namespace modebank
