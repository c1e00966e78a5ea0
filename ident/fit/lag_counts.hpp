#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace modebank {

/// What models with so many lags predicted of training runs that were left out.
struct LagCountScore {
  std::string varied;  ///< state_lags or input_lags: which of them was being counted
  std::ptrdiff_t state_lags = 1;
  std::ptrdiff_t input_lags = 1;
  std::ptrdiff_t samples = 0;  ///< that every count predicted
  double log_score = 0.0;      ///< [nats/sample]
  double loss = 0.0;           ///< against the best of these counts [nats/sample]
  double loss_standard_error = 0.0;
  bool chosen = false;
};

/// What window.state_lags = auto and window.input_lags = auto found.
struct LagCounts {
  std::ptrdiff_t state_lags = 1;
  std::ptrdiff_t input_lags = 1;
  std::vector<LagCountScore> scores;
};

}  // namespace modebank
