#pragma once

#include <string>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "ident/lag/estimate.hpp"
#include "ident/lag/pooled_estimate.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// How inputs are shifted. none: inputs are not shifted. pooled: all runs are shifted by the pooled lag.
enum class LagCorrection { none, pooled };

template <>
struct EnumNames<LagCorrection> {
  static constexpr Names<2> values{"none", "pooled"};
};

/// Estimates of one run and the lag that was applied. The estimates of held-out runs are NaN.
struct RunLag {
  std::string run;
  LagStatus status = LagStatus::not_estimated;
  double lag_s = not_a_number;  ///< dead time
  double lag_standard_error_s = not_a_number;
  double time_constant_s = not_a_number;
  double r_squared = not_a_number;
  double applied_lag_s = 0.0;
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
  PooledEstimate lag;  ///< [s] dead time of the training runs
  std::vector<LagScore> scores;
  std::vector<RunLag> runs;  ///< lags of the runs, in run order
};

}  // namespace modebank
