#pragma once

#include <string>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "ident/lag/estimate.hpp"
#include "ident/lag/pooled_estimate.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// How inputs are shifted. none: inputs are not shifted. pooled: all runs are shifted by the pooled lag. per_run:
/// training runs are shifted by their own lags, and held-out runs by the pooled lag. drift: like per_run, but the lags
/// also drift.
enum class LagCorrection { none, pooled, per_run, drift };

template <>
struct EnumNames<LagCorrection> {
  static constexpr Names<4> values{"none", "pooled", "per_run", "drift"};
};

/// Estimates of one run and the correction that was applied. The estimates of held-out runs are NaN.
struct RunLag {
  std::string run;
  LagStatus status = LagStatus::not_estimated;
  double lag_s = not_a_number;  ///< dead time, estimated without a drift
  double lag_standard_error_s = not_a_number;
  double time_constant_s = not_a_number;
  double r_squared = not_a_number;
  LagStatus drift_status = LagStatus::not_estimated;
  double drifting_lag_s = not_a_number;  ///< dead time in the middle of the run, estimated together with a drift
  double drifting_lag_standard_error_s = not_a_number;
  double clock_drift = not_a_number;  ///< [s/s]
  double clock_drift_standard_error = not_a_number;
  double match_s = not_a_number;  ///< delay of best match: median over the windows of the run
  double match_least_s = not_a_number;
  double match_largest_s = not_a_number;
  Eigen::Index match_windows = 0;
  double applied_lag_s = 0.0;  ///< lag that was applied, at the time applied_reference_s
  double applied_clock_drift = 0.0;
  double applied_reference_s = 0.0;

  InputClock applied() const { return {applied_lag_s, applied_clock_drift, applied_reference_s}; }
};

/// Scores of one correction on training runs that were left out in turn.
struct LagScore {
  LagCorrection correction = LagCorrection::none;
  Eigen::Index transitions = 0;
  double log_score = not_a_number;            ///< log score of the global model's one-step prediction [nats per
                                              ///< transition]
  double rmse = not_a_number;                 ///< root mean square of the one-step error, over all states
  double gain = 0.0;                          ///< gain of log_score over `none`
  double gain_standard_error = not_a_number;  ///< standard error of the gain, over the left-out runs
};

/// Result of data.lag_s = auto.
struct LagReport {
  LagCorrection correction = LagCorrection::none;
  PooledEstimate lag;        ///< [s] dead time of the training runs, estimated without a drift
  PooledEstimate start_lag;  ///< [s] dead time at the start of a run, estimated together with a drift
  PooledEstimate drift;      ///< [s/s]
  std::vector<LagScore> scores;
  std::vector<RunLag> runs;  ///< lags of the runs, in run order
};

}  // namespace modebank
