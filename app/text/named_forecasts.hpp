#pragma once

#include <string>
#include <vector>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The filter to use for predictions a number of steps ahead, and its gain on the judged runs.
struct NamedForecast {
  Index steps = 1;
  std::string filter;
  std::string other;             ///< filter to compare with: the bank; if the named filter is the bank, the best other
                                 ///< filter
  double gain = not_a_number;    ///< gain of log score over `other` [nats/sample]
  double error = not_a_number;   ///< standard error over the runs; NaN for fewer than two runs
  std::string c_filter;          ///< the best filter that can be exported to C; empty if this is `filter` itself
  double c_loss = not_a_number;  ///< log score that c_filter loses against `filter` [nats/sample]
};

/// One entry per scored horizon, horizon 1 first; empty without scores.
/// - Only training runs decide. Their predictions come from filters that were learned without them (/bank/left_out). If
///   no runs were left out, they come from the archive's filters.
/// - Of the filters with a log score less than 0.02 nats below the best, the simplest is named: a competitor in their
///   order, the bank, then the combination. Nothing is named against the finding's simpler model (or best competitor)
///   that is as good on the judged runs.
std::vector<NamedForecast> named_forecasts(const Archive& archive);

/// One sentence on the finding and the named filters, such as: "to understand the motion: the 3 modes; to predict 1
/// step ahead: `--track.filter combined` (+0.041 +- 0.012 nats over `drifting`; ...); 10 steps ahead: ...". Gains are
/// over the finding's best competitor.
std::string use_words(const Archive& archive);

}  // namespace modebank::app
