#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The filter to use for predictions a number of steps ahead.
struct NamedForecast {
  Index steps = 1;
  std::string filter;
  Eigen::VectorXd rmse;  ///< n_y, on the judged runs [state unit]; empty if unknown
  std::string c_filter;  ///< the filter to export to C: the named one, or the best one that can be exported
};

/// What the C code of `export --to c` does not support of a bank; empty if it supports all.
std::string c_lacks(const Bank& bank);

/// One entry per scored horizon, horizon 1 first; empty without scores.
/// - Only training runs decide. Their predictions come from filters that were learned without them (/bank/left_out). If
///   no runs were left out, they come from the archive's filters.
/// - Of the filters with a log score less than 0.02 nats below the best, the simplest is named: a competitor in their
///   order, the bank, then the combination. Nothing is named against the finding's simpler model (or best competitor)
///   that is as good on the judged runs.
std::vector<NamedForecast> named_forecasts(const Archive& archive);

/// One sentence on the finding and the named filters, such as: "to understand the motion: the 3 modes; to predict 1
/// step ahead: `--track.filter combined` (RMSE 0.0301); 10 steps ahead: ...".
std::string use_words(const Archive& archive, const std::vector<NamedForecast>& forecasts);

}  // namespace modebank::app
